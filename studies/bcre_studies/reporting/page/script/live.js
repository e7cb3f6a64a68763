// Try: the automaton itself, live, on a slope that the reader chooses.

const SLOPE = { length: 100, width: 3, Sc: 0.5 };
const SPENT = 1e-6; // an avalanche is over when its largest R is this part of the pulse

function startLive(root) {
  const find = (name) => root.querySelector(`[data-part="${name}"]`);
  const inputs = Object.fromEntries(["S0", "pulse", "v", "D", "gamma", "d", "place"].map(
    (name) => [name, root.querySelector(`[name="${name}"]`)]
  ));
  const play = find("play");
  let p, pile, t, steps, started, timer = null, last = 0, over = false;

  // Sliders of quantities that range over decades hold the exponent.
  const value = (name) => {
    const input = inputs[name], raw = Number(input.value);
    return input.dataset.scale === "log" ? 10 ** raw : raw;
  };

  function reset() {
    stop();
    p = { Sc: SLOPE.Sc };
    for (const name of ["v", "D", "gamma", "d"]) p[name] = value(name);
    p.d = SLOPE.length / Math.round(SLOPE.length / p.d);
    const S0 = SLOPE.Sc + value("S0"), pulse = value("pulse");
    pile = inclineWithPulse(p, S0, pulse, value("place"), SLOPE.width, SLOPE.length);
    started = { S0, pulse, top: S0 - SLOPE.Sc, h: pile.h.slice() };
    t = 0; steps = 0; over = false;
    for (const name of Object.keys(inputs)) {
      const output = root.querySelector(`output[for="${inputs[name].id}"]`);
      if (output) output.textContent = shortNumber(name === "d" ? p.d : value(name));
      if (output) inputs[name].setAttribute("aria-valuetext", output.textContent);
    }
    predict();
    draw();
  }

  function predict() {
    const own = excessOfAutomaton(p), bcre = excessOfBcre(p), excess = started.S0 - SLOPE.Sc;
    find("sd-ca").textContent = shortNumber(own);
    find("sd-pde").textContent = shortNumber(bcre);
    find("peclet").textContent = shortNumber(p.v * p.d / p.D);
    find("deff").textContent = shortNumber(p.D + p.v * p.d / 2);
    const where = excess > bcre ? "above both: any disturbance brings the slope down, in both models."
      : excess > own ? "between the two: the models disagree about a small disturbance."
        : excess > 0 ? "below both: a small disturbance is swept downhill; a large one may still climb."
          : "at or below repose: the pulse is laid down as it goes.";
    find("where").textContent = `S0 − Sc = ${shortNumber(excess)} is ${where}`;
  }

  function draw() {
    const x = (i) => (i + 0.5) * p.d;
    const u = pile.h.map((h, i) => h + SLOPE.Sc * x(i) - SLOPE.Sc * SLOPE.length);
    const start = started.h.map((h, i) => h + SLOPE.Sc * x(i) - SLOPE.Sc * SLOPE.length);
    const ends = [Math.min(0, ...start, ...u), Math.max(1e-3, ...start, ...u)];
    const most = Math.max(1e-12, ...pile.R);
    drawChart(find("u"), { length: SLOPE.length, range: niceRange(...ends), unit: "x, downhill",
      lines: [{ values: start, colour: "quiet", dash: [4, 4], width: 1 },
        { values: u, colour: "ca", width: 2.2, fill: true }] });
    drawChart(find("R"), { length: SLOPE.length, range: niceRange(0, most), unit: "x, downhill",
      lines: [{ values: pile.R, colour: "ca", width: 2.2, fill: true }] });
    const S = fittedSlope(pile.h, p.d);
    find("time").textContent = shortNumber(t);
    find("steps").textContent = String(steps);
    find("slope").textContent = shortNumber(Math.abs(S - SLOPE.Sc) < 5e-6 ? 0 : S - SLOPE.Sc);
    return { S, most };
  }

  function verdict(S) {
    const change = S - started.S0, excess = started.S0 - SLOPE.Sc;
    if (excess > 0.01 && Math.abs(S - SLOPE.Sc) < 0.01) return "The avalanche ran to the top: the slope came down to repose, S = Sc.";
    if (change > 0.001) return `The slope became steeper, by ${shortNumber(change)}.`;
    if (change < -0.001) return `The slope became less steep, by ${shortNumber(-change)}.`;
    return "The slope stands as it was, to three digits.";
  }

  // As much simulated time as the avalanche needs to cross the slope in some seconds.
  function advance(seconds) {
    let span = seconds * Number(find("speed").value) * SLOPE.length / Math.max(p.v, 0.02) / 10;
    const until = performance.now() + 12; // what a frame leaves, drawing apart
    while (span > 0 && performance.now() < until) {
      const dt = Math.min(MARGIN * stableStep(pile.h, pile.R, p), span);
      if (!(dt > 0)) break;
      step(pile.h, pile.R, fold(p, dt));
      t += dt; span -= dt; steps += 1;
    }
  }

  function tick(now) {
    advance(Math.max(0, Math.min((now - last) / 1000, 0.05)));
    last = now;
    const { S, most } = draw();
    if (most <= SPENT * started.pulse) {
      over = true;
      stop();
      find("outcome").textContent = verdict(S);
      return;
    }
    timer = requestAnimationFrame(tick);
  }

  function stop() {
    cancelAnimationFrame(timer);
    timer = null;
    play.textContent = over ? "Again" : "Run";
  }

  function start() {
    if (over) reset();
    find("outcome").textContent = "Running.";
    play.textContent = "Pause";
    last = performance.now();
    timer = requestAnimationFrame(tick);
  }

  play.addEventListener("click", () => (timer === null ? start() : stop()));
  find("reset").addEventListener("click", () => { reset(); find("outcome").textContent = "Ready."; });
  Object.values(inputs).forEach((input) => input.addEventListener("input", () => {
    reset();
    find("outcome").textContent = "Ready.";
  }));
  root.querySelectorAll("[data-preset]").forEach((button) => button.addEventListener("click", () => {
    for (const [name, number] of Object.entries(JSON.parse(button.dataset.preset))) {
      const input = inputs[name];
      input.value = input.dataset.scale === "log" ? Math.log10(number) : number;
    }
    reset();
    start();
  }));
  reset();
  return () => draw();
}
