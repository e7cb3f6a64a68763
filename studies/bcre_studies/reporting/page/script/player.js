// Watch: stored frames of both models; play, scrub, speed, keyboard.

const RATE = 12; // stored frames a second

function startPlayer(root) {
  const find = (name) => root.querySelector(`[data-part="${name}"]`);
  const [choice, play, scrub, speed] = ["scene", "play", "scrub", "speed"].map(find);
  const shown = [...root.querySelectorAll("[data-model]")];
  const scenes = {};
  let scene, frame = 0, timer = null, began = 0, from = 0;

  const percent = (value) => (value === null ? "–" : `${+(100 * value).toPrecision(2)} %`);

  function draw() {
    const names = shown.filter((box) => box.checked).map((box) => box.dataset.model);
    const lines = (field) => names.map((name) => (
      { values: scene.models[name][field](frame), ...LOOKS[name] }
    ));
    const R = lines("R");
    const most = Math.max(1e-9, ...R.map((line) => Math.max(...line.values)));
    const relative = find("relative").checked;
    const surface = lines(relative ? "change" : "u");
    drawChart(find("u"), { lines: surface, length: scene.length, unit: "x, downhill",
      range: relative ? scene.changed : scene.range });
    find("surface").hidden = relative;
    find("surface-change").hidden = !relative;
    drawChart(find("R"), { lines: R, length: scene.length, range: niceRange(0, most),
      unit: "x, downhill" });
    scrub.value = frame;
    const t = shortNumber(scene.t[frame]);
    scrub.setAttribute("aria-valuetext", `t = ${t}`);
    find("time").textContent = t;
    find("difference").textContent = percent(scene.difference[frame]);
    find("left").textContent = percent(scene.left[frame]);
    find("error").textContent = percent(scene.error[frame]);
    root.classList.toggle("unresolved", scene.unresolved[frame]);
    find("unresolved").textContent = scene.unresolved[frame]
      ? "BCRE is unresolved here: its own error is not small against the difference." : "";
  }

  function show(name) {
    scene = scenes[name] || (scenes[name] = readScene(name));
    if (!scene.range) {
      const around = (ends) => niceRange(
        Math.min(...ends.map((end) => end[0])), Math.max(...ends.map((end) => end[1])));
      const models = Object.values(scene.models);
      scene.range = around(models.map((model) => model.ends));
      scene.changed = around(models.map((model) => model.changed));
    }
    scrub.max = scene.t.length - 1;
    find("title").textContent = scene.title;
    frame = 0;
    find("relative").checked = hardlyMoves();
    draw();
  }

  // Where the surface changes by less than a tenth of its height, only the change can be seen.
  function hardlyMoves() {
    return scene.changed[1] - scene.changed[0] < 0.1 * (scene.range[1] - scene.range[0]);
  }

  function stop() {
    cancelAnimationFrame(timer);
    timer = null;
    play.textContent = "Play";
  }

  function tick(now) {
    const passed = Math.max(0, now - began) / 1000; // a frame's time may lie before the click
    const next = from + Math.floor(passed * RATE * Number(speed.value));
    if (next !== frame) {
      frame = Math.min(next, scene.t.length - 1);
      draw();
    }
    if (frame >= scene.t.length - 1) stop();
    else timer = requestAnimationFrame(tick);
  }

  function start() {
    if (frame >= scene.t.length - 1) frame = 0;
    from = frame;
    began = performance.now();
    play.textContent = "Pause";
    timer = requestAnimationFrame(tick);
  }

  function go(to) {
    stop();
    frame = Math.max(0, Math.min(scene.t.length - 1, to));
    draw();
  }

  play.addEventListener("click", () => (timer === null ? start() : stop()));
  scrub.addEventListener("input", () => go(Number(scrub.value)));
  choice.addEventListener("change", () => { stop(); show(choice.value); });
  speed.addEventListener("change", () => { if (timer !== null) { stop(); start(); } });
  shown.forEach((box) => box.addEventListener("change", draw));
  find("relative").addEventListener("change", draw);
  root.addEventListener("keydown", (event) => {
    if (event.target.matches("select, button, input") || event.ctrlKey || event.metaKey) return;
    const moves = { ArrowLeft: frame - 1, ArrowRight: frame + 1, Home: 0, End: scene.t.length - 1 };
    if (event.key === " ") play.click();
    else if (event.key in moves) go(moves[event.key]);
    else return;
    event.preventDefault();
  });
  show(choice.value);
  return draw;
}
