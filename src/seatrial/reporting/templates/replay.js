"use strict";
// A run simulated again: the scheme of seatrial/numerics/kernels/integrate.py (Hairer, Norsett & Wanner 1993, table
// II.1.2), inputs linear between samples, or held (`held`). `limits`: magnitudes of the states that no ship exceeds.
// Returns the states sample by sample, and the sample at which one left its limits (-1: none did).
function replay(rates, { dt, count, start, inputs, held, limits }, p) {
  const n = start.length, width = inputs.length, x = Float64Array.from(start);
  const [k1, k2, k3, k4, y] = Array.from({ length: 5 }, () => new Float64Array(n));
  const [u0, um, u1] = Array.from({ length: 3 }, () => new Float64Array(width));
  const states = start.map(() => new Float64Array(count).fill(NaN));
  const value = (j, k) => inputs[j].length === 1 ? inputs[j][0] : inputs[j][k];
  for (let j = 0; j < width; j++) u0[j] = value(j, 0);
  for (let row = 0; row < count; row++) {
    for (let i = 0; i < n; i++) if (!(Math.abs(x[i]) <= limits[i])) return { states, failed: row };
    for (let i = 0; i < n; i++) states[i][row] = x[i];
    if (row === count - 1) break;
    for (let j = 0; j < width; j++) {
      const half = held[j] ? 0.0 : 0.5 * (value(j, row + 1) - u0[j]);
      um[j] = u0[j] + half;
      u1[j] = um[j] + half;
    }
    rates(x, u0, p, k1);
    for (let i = 0; i < n; i++) y[i] = x[i] + 0.5 * dt * k1[i];
    rates(y, um, p, k2);
    for (let i = 0; i < n; i++) y[i] = x[i] + 0.5 * dt * k2[i];
    rates(y, um, p, k3);
    for (let i = 0; i < n; i++) y[i] = x[i] + dt * k3[i];
    rates(y, u1, p, k4);
    for (let i = 0; i < n; i++) x[i] += dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    for (let j = 0; j < width; j++) u0[j] = held[j] ? value(j, row + 1) : u1[j];
  }
  return { states, failed: -1 };
}
