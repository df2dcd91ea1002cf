// Numbers as people read them.

function digits(value, count = 6) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  const text = exponent < -5 || exponent >= 12 ? value.toExponential(count - 1) : String(Number(value.toPrecision(count)));
  return text.replace("-", "−");
}

function thousandths(value) {
  if (value === null || value === undefined) return "–";
  return (Math.round(value * 1000) / 1000 + 0).toFixed(3).replace("-", "−");
}

// A value to the second significant digit of its standard error, as the command line prints it: further digits are noise.
function toItsError(value, error) {
  if (value === null || value === undefined || !Number.isFinite(value) || !(error > 0)) return digits(value);
  const places = 1 - Math.floor(Math.log10(error));
  if (places > 6 || places < -10) return digits(value);
  const unit = 10 ** -places;
  // Adding 0 turns -0 into 0.
  const text = places >= 0 ? value.toFixed(places) : String(Math.round(value / unit) * unit + 0);
  return text.replace("-", "−");
}

function withError(value, error) {
  if (value === null || value === undefined) return "–";
  return error ? `${toItsError(value, error)} ± ${toItsError(error, error)}` : digits(value);
}

function unitText(unit) {
  return unit.replace("^2", "²").replace("^3", "³");
}

function titled(what) {
  return what.unit ? `${what.title} (${unitText(what.unit)})` : what.title;
}

// The least of round numbers that is no smaller.
function roundedUp(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return decade * [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].find(factor => factor * decade >= value * (1 - 1e-9));
}

// Round values between two.
function ticks([low, high], most = 6) {
  const raw = (high - low) / most;
  if (!(raw > 0)) return [low];
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = decade * [1, 2, 5, 10].find(factor => factor * decade >= raw * (1 - 1e-9));
  const marks = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) marks.push(Number((n * step).toPrecision(12)));
  return marks;
}

// The values below which shares of the weight lie, of values that are numbers.
function quantiles(values, weights, shares) {
  const order = [];
  let total = 0;
  for (let i = 0; i < values.length; i++) if (!Number.isNaN(values[i])) { order.push(i); total += weights[i]; }
  const sorted = Uint32Array.from(order).sort((a, b) => values[a] - values[b]);
  const found = shares.map(() => NaN);
  let passed = 0, n = 0;
  for (const i of sorted) {
    passed += weights[i];
    while (n < shares.length && passed >= shares[n] * total) found[n++] = values[i];
  }
  while (n < shares.length && sorted.length) found[n++] = values[sorted[sorted.length - 1]];
  return found;
}
