// The paper's rule, as bcre_ca.line.step writes it: the same operations in the same order.
// A pile is {h, R}: Float64Arrays of the static and the rolling layer; p holds v, D, gamma, Sc, d.

const MARGIN = 0.8; // part of the largest stable step that is taken, as in bcre_ca.line.evolve

function fold(p, dt) {
  const c = p.v * dt / p.d, b = p.D * dt / (p.d * p.d);
  return { c, b, q: c + b, k: p.gamma * dt / p.d, s: p.Sc * p.d };
}

// One step in place, closed top and open foot; returns what left through the foot, in units of R.
function step(h, R, K) {
  const last = h.length - 1;
  let into = 0;
  for (let i = 0; i < last; i++) {
    const out = K.q * R[i] - K.b * R[i + 1];
    const eroded = R[i] * (K.k * ((h[i] - h[i + 1]) - K.s));
    h[i] -= eroded;
    R[i] += (into - out) + eroded;
    into = out;
  }
  const out = K.c * R[last];
  R[last] += into - out;
  return out;
}

// Largest step that keeps R >= 0 and lets the surface wave cross at most one cell.
function stableStep(h, R, p) {
  let most = 0, short = 0;
  for (let i = 0; i < R.length; i++) if (R[i] > most) most = R[i];
  for (let i = 0; i + 1 < h.length; i++) short = Math.max(short, p.Sc * p.d - (h[i] - h[i + 1]));
  const layer = p.v / p.d + 2 * (p.D / (p.d * p.d)) + p.gamma * short / p.d;
  return Math.min(1 / layer, 1 / (p.gamma / p.d * most));
}

// Sd - Sc in closed form.
function excessOfAutomaton(p) {
  const a = p.v / p.d + p.D / (p.d * p.d), b = p.D / (p.d * p.d);
  return (Math.sqrt(a) - Math.sqrt(b)) ** 2 / p.gamma;
}

function excessOfBcre(p) {
  return p.v * p.v / (4 * p.D * p.gamma);
}

// Least-squares slope -dh/dx over the middle half.
function fittedSlope(h, d) {
  const length = h.length * d;
  let n = 0, sx = 0, sh = 0, sxx = 0, sxh = 0;
  for (let i = 0; i < h.length; i++) {
    const x = (i + 0.5) * d;
    if (x < length / 4 || x > length * 3 / 4) continue;
    n += 1; sx += x; sh += h[i]; sxx += x * x; sxh += x * h[i];
  }
  return -(n * sxh - sx * sh) / (n * sxx - sx * sx);
}

function inclineWithPulse(p, S0, pulse, centre, width, length) {
  const cells = Math.round(length / p.d);
  const h = new Float64Array(cells), R = new Float64Array(cells);
  for (let i = 0; i < cells; i++) {
    const x = (i + 0.5) * p.d;
    h[i] = S0 * (length - x);
    R[i] = pulse * Math.exp(-(((x - centre) / width) ** 2));
  }
  return { h, R };
}
