// Colours of a share from 0 to 1: five of viridis, lightened so that shades are seen on them, and what lies between.

const STOPS = [
  [68, 1, 84],
  [59, 82, 139],
  [33, 145, 140],
  [94, 201, 98],
  [253, 231, 37],
].map((stop) => stop.map((one) => 0.8 * one + 0.2 * 255));

/** Red, green and blue of a share, from 0 to 255; NaN is grey. */
export function colour(share) {
  if (!(share >= 0)) return [128, 128, 128];
  const at = Math.min(share, 1) * (STOPS.length - 1), k = Math.min(Math.floor(at), STOPS.length - 2);
  return STOPS[k].map((one, i) => one + (at - k) * (STOPS[k + 1][i] - one));
}

/** The same as a gradient of a style sheet. */
export function gradient() {
  return `linear-gradient(to right, ${STOPS.map((one) => `rgb(${one.join(" ")})`).join(", ")})`;
}
