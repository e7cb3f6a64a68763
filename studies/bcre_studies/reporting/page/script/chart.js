// A small line chart on a canvas, in the colours of the style sheet.

function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function niceStep(span, ticks) {
  const rough = span / ticks, size = 10 ** Math.floor(Math.log10(rough));
  return [1, 2, 5, 10].map((m) => m * size).find((s) => s >= rough * 0.999);
}

// A range that changes rarely: the next round number outside the values.
function niceRange(low, high) {
  if (!(high > low)) { low -= 0.5; high += 0.5; }
  const step = niceStep(high - low, 4);
  return [Math.floor(low / step + 1e-9) * step, Math.ceil(high / step - 1e-9) * step];
}

function shortNumber(value) {
  const size = Math.abs(value);
  if (size < 1e-12) return "0";
  if (size >= 1e6 || size < 1e-3) return value.toExponential(1).replace(".0e", "e").replace("e+", "e").replaceAll("-", "−");
  return String(+value.toPrecision(3)).replace("-", "−");
}

// lines: [{values, colour, dash, width, fill}], all over the same length
function drawChart(canvas, { lines, length, range, unit }) {
  const box = canvas.getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
  if (!box.width) return;
  canvas.width = Math.round(box.width * ratio);
  canvas.height = Math.round(box.height * ratio);
  const g = canvas.getContext("2d");
  g.scale(ratio, ratio);
  g.font = `12px ${colour("sans") || "sans-serif"}`;
  const [low, high] = range;
  const left = 44, right = box.width - 18, top = 10, bottom = box.height - 34;
  const X = (x) => left + x / length * (right - left);
  const Y = (y) => bottom - (y - low) / (high - low) * (bottom - top);
  g.lineWidth = 1;
  g.textBaseline = "middle";
  const dy = niceStep(high - low, Math.max(2, (bottom - top) / 45));
  for (let y = Math.ceil(low / dy - 1e-9) * dy; y <= high + dy * 1e-6; y += dy) {
    g.strokeStyle = colour("line");
    g.beginPath(); g.moveTo(left, Y(y)); g.lineTo(right, Y(y)); g.stroke();
    g.fillStyle = colour("quiet"); g.textAlign = "right";
    g.fillText(shortNumber(Math.abs(y) < dy * 1e-6 ? 0 : y), left - 6, Y(y));
  }
  g.textAlign = "center"; g.textBaseline = "top";
  const dx = niceStep(length, Math.max(2, (right - left) / 90));
  for (let x = 0; x <= length + 1e-9; x += dx) g.fillText(shortNumber(x), X(x), bottom + 5);
  g.textAlign = "right";
  g.fillText(unit, right + 10, bottom + 19);
  g.save();
  g.beginPath(); g.rect(left, top - 4, right - left, bottom - top + 8); g.clip();
  for (const line of lines) {
    const n = line.values.length, d = length / n;
    g.beginPath();
    for (let i = 0; i < n; i++) {
      const x = X((i + 0.5) * d), y = Y(line.values[i]);
      if (i) g.lineTo(x, y); else g.moveTo(x, y);
    }
    g.strokeStyle = colour(line.colour);
    g.lineWidth = line.width || 2;
    g.setLineDash(line.dash || []);
    g.stroke();
    if (line.fill) {
      g.lineTo(X(length - d / 2), Y(Math.max(low, 0))); g.lineTo(X(d / 2), Y(Math.max(low, 0)));
      g.globalAlpha = 0.14; g.fillStyle = colour(line.colour); g.fill(); g.globalAlpha = 1;
    }
  }
  g.setLineDash([]);
  g.restore();
}

const LOOKS = {
  "ca": { colour: "ca", dash: [], width: 2.2 },
  "pde": { colour: "pde", dash: [8, 4], width: 2 },
  "pde effective": { colour: "eff", dash: [2, 3], width: 3 },
};
