import palette from "../../../../data/palette.json";

/** Of a pair of data/palette.json. */
const on = (theme, [light, dark]) => (theme === "dark" ? dark : light);

export const DASHES = [[], [9, 4], [3, 3], [9, 3, 2, 3], [14, 5], [2, 5]];

/** A robot has its colour by identity, in all runs: src/robot_colors.cpp chooses it. */
export const robotColor = (robot, theme) => on(theme, robot.colors);

export const phaseColor = (phase, theme) => on(theme, palette.phases[phase] ?? palette.other);

/** Of the i-th run of a comparison. */
export const runColor = (i, theme) => on(theme, palette.runs[i % palette.runs.length]);

export const otherColor = (theme) => on(theme, palette.other);

const scene = (theme, more) => ({ ink: on(theme, palette.team), frontier: on(theme, palette.frontier), ...more });
export const SCENE = {
  light: scene("light", { background: "#eef1f5", shade: 1.0, wall: "#e4e8ee", heights: ["#566a8c", "#8fa0ae", "#c9c4b2", "#e9dcb4"] }),
  dark: scene("dark", { background: "#10141a", shade: 0.92, wall: "#4a5563", heights: ["#3d4f74", "#66788c", "#a09c8c", "#d8c994"] }),
};

/** From dark violet (0) over teal to light yellow (1), as `frontlux render` draws view quality: [r, g, b], 0 to 255. */
export function qualityColor(fraction) {
  const t = Math.min(Math.max(fraction, 0), 1);
  const lightness = 0.28 + 0.64 * t, hue = ((302 - 197 * t) * Math.PI) / 180;
  const chroma = t < 0.5 ? 0.15 - 0.1 * t : 0.1 + 0.16 * (t - 0.5);
  const a = chroma * Math.cos(hue), b = chroma * Math.sin(hue);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    encoded(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

function encoded(linear) {
  const c = Math.min(Math.max(linear, 0), 1);
  return Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
}

/** A CSS gradient of the scale, or of the heights' colours. */
export function scaleGradient(colors) {
  return `linear-gradient(to right, ${colors.join(", ")})`;
}

export function qualityStops() {
  return Array.from({ length: 9 }, (_, i) => `rgb(${qualityColor(i / 8).join(",")})`);
}
