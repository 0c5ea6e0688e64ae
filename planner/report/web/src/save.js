import { SCENE } from "./palette.js";

const CAPTION = 34; // [px] below a saved view
const WIDTH = 720, HEIGHT = 400, LEFT = 74, RIGHT = 20, TOP = 74, BOTTOM = 52; // of a saved chart with one line of names
const NAMES = 18; // [px] height of another line of names
const FONT = "system-ui, 'DejaVu Sans', sans-serif";

/** Offers a file to be saved. */
export function save(name, blob) {
  const link = document.createElement("a"), url = URL.createObjectURL(blob);
  link.href = url;
  link.download = name.replace(/[^\w.+-]+/g, "_");
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** What a view shows as a PNG picture, with a caption: words, and names with their colours. */
export function viewPicture(scene, words, names) {
  scene.render(); // the canvas keeps its picture until the end of this task only
  const { canvas } = scene, scale = scene.renderer.getPixelRatio(), colors = SCENE[scene.theme];
  const picture = document.createElement("canvas"), caption = CAPTION * scale;
  picture.width = canvas.width;
  picture.height = canvas.height + caption;
  const paint = picture.getContext("2d");
  paint.fillStyle = colors.background;
  paint.fillRect(0, 0, picture.width, picture.height);
  paint.drawImage(canvas, 0, 0);
  paint.font = `${14 * scale}px ${FONT}`;
  paint.textBaseline = "middle";
  let x = 12 * scale;
  const y = canvas.height + caption / 2;
  const write = (text) => {
    paint.fillStyle = colors.ink;
    paint.fillText(text, x, y);
    x += paint.measureText(text).width + 16 * scale;
  };
  for (const { name, color } of names) {
    paint.fillStyle = color;
    paint.fillRect(x, y - 6 * scale, 12 * scale, 12 * scale);
    x += 18 * scale;
    write(name);
  }
  write(words);
  return new Promise((done) => picture.toBlob(done, "image/png"));
}

const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
const drawn = (spec) => spec.series.filter((series) => !series.edge);

/** The numbers of a chart as a table with commas: a row for each x, a column for each curve. */
export function chartTable(spec) {
  const cell = (value) => (typeof value === "number" ? (Number.isFinite(value) ? String(value) : "") : /[",\n\r]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value);
  const row = (cells) => `${cells.map((value) => cell(value ?? "")).join(",")}\n`;
  const columns = spec.series.map((series, i) => (series.edge ? `${spec.series.find((other, k) => k > i && other.band).name}, ${spec.series[i + 1].edge ? "high" : "low"}` : series.name));
  const head = row([spec.x.label, ...columns]);
  if (spec.series.every((series) => series.xs === spec.x.xs)) return head + spec.x.xs.map((x, i) => row([x, ...spec.series.map((series) => series.ys[i])])).join("");
  // Curves of several runs: a row for each point of each curve.
  return head + spec.series.flatMap((series, c) => series.xs.map((x, i) => row([x, ...spec.series.map((_, k) => (k === c ? series.ys[i] : ""))]))).join("");
}

/** 1, 2 or 5 times a power of ten, so that at most so many steps fit. */
function roundStep(largest, most) {
  const power = 10 ** Math.floor(Math.log10(largest / most));
  return power * [1, 2, 5, 10].find((times) => times * power * most >= largest * (1 - 1e-9));
}

const strokeOf = ({ color, dash, width }) => `stroke="${color}" stroke-width="${width ?? 1.75}"${dash ? ` stroke-dasharray="${dash.join(" ")}"` : ""}`;

/** The curves with where their names begin in a saved chart: { x, line, series }, in lines that end before `right`. */
function namesOf(spec, right) {
  let x = 16, line = 0;
  return drawn(spec).map((series) => {
    const width = 30 + 7 * series.name.length;
    if (x > 16 && x + width > right) [x, line] = [16, line + 1];
    const at = { x, line, series };
    x += width + 16;
    return at;
  });
}

/**
 * A chart as an SVG file, on white. `format` writes a value of the upright axis. `bars`, of a stacked chart: the ends of the
 * bars, and their sums up to each curve, the tallest first.
 */
export function chartSvg(spec, format, bars) {
  const { ink } = SCENE.light, right = WIDTH - RIGHT, parts = [], names = namesOf(spec, right);
  const more = NAMES * Math.max(0, names.at(-1)?.line ?? 0), top = TOP + more, height = HEIGHT + more, bottom = height - BOTTOM;
  const curves = spec.stacked ? spec.series.map((series, p) => ({ ...series, xs: bars[0], ys: bars.at(-1 - p) })).reverse() : spec.series;
  const xEnd = Math.max(...spec.series.map(({ xs }) => xs.at(-1))) || 1;
  const yEnd = spec.fraction ? 1 : 1.06 * curves.reduce((most, { ys }) => ys.reduce((a, y) => (y > a ? y : a), most), 0) || 1;
  const at = (x, y) => `${(LEFT + (x / xEnd) * (right - LEFT)).toFixed(1)} ${(bottom - (y / yEnd) * (bottom - top)).toFixed(1)}`;
  const path = ({ xs, ys }) => xs.map((x, i) => [x, ys[i]]).filter(([, y]) => Number.isFinite(y)).map(([x, y]) => at(x, y));
  const text = (x, y, words, more = "") => parts.push(`<text x="${x}" y="${y}" ${more}>${escaped(words)}</text>`);
  for (let step = roundStep(yEnd, 5), y = 0; y <= yEnd * (1 + 1e-9); y += step) {
    const [x0, y0] = at(0, y).split(" ");
    parts.push(`<path d="M${x0} ${y0}H${right}" stroke="#d9dfe7"/>`);
    text(LEFT - 8, Number(y0) + 4, format(y), 'text-anchor="end"');
  }
  for (let step = roundStep(xEnd, 8), x = 0; x <= xEnd * (1 + 1e-9); x += step) text(at(x, 0).split(" ")[0], bottom + 18, Number(x.toPrecision(12)), 'text-anchor="middle"');
  text((LEFT + right) / 2, height - 12, spec.x.label, 'text-anchor="middle"');
  curves.forEach((series, i) => {
    if (series.edge) {
      if (curves[i + 1].edge) parts.push(`<path d="M${[...path(series), ...path(curves[i + 1]).reverse()].join("L")}Z" fill="${series.color}" fill-opacity="0.22"/>`);
    } else if (spec.stacked) {
      // A bar reaches back to the one before; taller ones are drawn first.
      const corners = series.xs.flatMap((end, k) => [at(series.xs[k - 1] ?? 0, series.ys[k]), at(end, series.ys[k])]);
      parts.push(`<path class="curve" d="M${[at(0, 0), ...corners, at(series.xs.at(-1), 0)].join("L")}Z" fill="${series.color}"/>`);
    } else parts.push(`<path class="curve" d="M${path(series).join("L")}" fill="none" ${strokeOf(series)} stroke-linejoin="round"/>`);
  });
  text(16, 24, spec.title, 'font-size="16" font-weight="600"');
  for (const { x, line, series: { name, color, dash, width, band } } of names) {
    const y = 51 + NAMES * line;
    parts.push(spec.stacked || band ? `<rect x="${x}" y="${y - 5}" width="24" height="10" fill="${color}"/>` : `<path d="M${x} ${y}h24" ${strokeOf({ color, dash, width })}/>`);
    text(x + 30, y + 4, name);
  }
  text(right, 24, spec.note, 'text-anchor="end" fill-opacity="0.7"');
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${height}" width="${WIDTH}" height="${height}" font-family="${escaped(FONT)}" font-size="12" fill="${ink}"><rect width="${WIDTH}" height="${height}" fill="#ffffff"/>\n${parts.join("\n")}\n</svg>\n`;
}
