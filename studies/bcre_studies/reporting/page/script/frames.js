// Recorded layers, unpacked: 16-bit levels between a low and a high value, base64.

const LEVELS = 4095;

function unpacked(field, cells) {
  const text = atob(field.data), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const levels = new Uint16Array(bytes.length / 2);
  for (let i = 0; i < levels.length; i++) levels[i] = bytes[2 * i] | (bytes[2 * i + 1] << 8);
  return (frame) => {
    const at = field.low.length > 1 ? frame : 0;
    const low = field.low[at], span = field.high[at] - low;
    const values = new Float64Array(cells);
    for (let i = 0; i < cells; i++) values[i] = low + levels[frame * cells + i] / LEVELS * span;
    return values;
  };
}

function readScene(name) {
  const scene = JSON.parse(document.getElementById(`frames-${name}`).textContent);
  for (const model of Object.values(scene.models)) {
    const start = unpacked(model.start, scene.cells)(0);
    model.changed = [Math.min(0, ...model.change.low), Math.max(1e-9, ...model.change.high)];
    model.change = unpacked(model.change, scene.cells);
    model.u = (frame) => model.change(frame).map((change, i) => start[i] + change);
    model.R = unpacked(model.R, scene.cells);
  }
  return scene;
}
