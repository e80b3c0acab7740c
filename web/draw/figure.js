// @ts-check
// A figure as a drawing of its own, with title, axes, units and legend: for small charts on the page, for files and for
// print.

import { dress, s } from "./dom.js";
import { extent, number } from "../state/numbers.js";
import { placedNames } from "../state/series.js";

/** @import { OrderName } from "../state/series.js" */

const FRAME = { left: 62, right: 20, top: 14, bottom: 44 };
const LETTER = 11;
const FONT = "system-ui, sans-serif";

/** @typedef {{ name: string, color: string, dash?: number[] }} Named */

/** @typedef {{ x: number, y: number, width: number, height: number, color: string }} Cell */

/**
 * @typedef {{ name?: string, color?: string, dash?: number[], width?: number, parted?: boolean, x: number[],
 *   y: (number | null | undefined)[] }} FigureLine
 */

/** @typedef {{ x: number, y: number, label: string, strong?: boolean, open?: () => unknown }} Dot */

/** @typedef {{ name: string, color: string, x: number[], y: number[] }} Stems */

/**
 * @typedef {object} Parts
 * @property {string} title
 * @property {string} x
 * @property {string} y
 * @property {Cell[]} [cells]
 * @property {FigureLine[]} [lines]
 * @property {Dot[]} [points]
 * @property {Stems[]} [stems]
 * @property {OrderName[]} [names]
 * @property {{ colors: string[], words: [string, string] } | null} [scale]
 * @property {{ ink: string, grid: string } | null} [colors]
 * @property {number} [width]
 * @property {number} [height]
 * @property {boolean} [heading]
 * @property {number[] | null} [xRange]
 * @property {number[] | null} [yRange]
 * @property {string} [label]
 */

/**
 * Where a value of x is in a figure, and which value is at a place.
 *
 * @typedef {{ x: [number, number], px: (value: number) => number, valueAt: (at: number) => number, top: number,
 *   bottom: number }} Frame
 */

/** @typedef {SVGSVGElement & { frame: Frame }} Figure */

/** @typedef {Record<string, string | number | null | undefined>} Attributes */

/** @type {(text: string, attributes: Attributes) => SVGTextElement} */
const words = (text, attributes) => Object.assign(s("text", attributes), { textContent: text });

/**
 * Five or so round numbers between two.
 *
 * @type {(low: number, high: number, count?: number) => number[]}
 */
export function ticks(low, high, count = 5) {
  const raw = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = ([1, 2, 5, 10].find((each) => each * power >= raw * (1 - 1e-9)) ?? 10) * power;
  /** @type {number[]} */
  const found = [];
  for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + step * 1e-9; value += step)
    found.push(Math.abs(value) < step * 1e-9 ? 0 : value);
  return found;
}

/** The width of a figure unless its place has less room, and the least that one has. */
const [WIDTH, LEAST] = [520, 300];

/**
 * The width of a figure in `place`, at most `most`, where its letters are as large as those of the page.
 *
 * @type {(place: HTMLElement, most?: number) => number}
 */
export function roomIn(place, most = WIDTH) {
  const scale = parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
  return place.clientWidth ? Math.min(most, Math.max(LEAST, place.clientWidth / scale - 8)) : WIDTH;
}

/** @type {(values: (number | null | undefined)[], room: number) => [number, number]} */
function range(values, room) {
  const [least, most] = extent(values) ?? [0, 1];
  const more = (most - least || Math.abs(most) || 1) * room;
  return [least - more, most + more];
}

/**
 * A figure of `cells` `{ x, y, width, height, color }`, of `lines` `{ name, color, dash, width, parted, x, y }`, where
 * null breaks a line, of `points` `{ x, y, label, strong, open }`, where `open` is what a press of one does, and of
 * `stems` `{ name, color, x, y }`, over named axes, with `names` `{ order, label, value }` over stems, and a `scale` `{
 * colors, words }` of the colors of cells from their least to their most. Looks come from `colors`, or from the style
 * sheet where there are none. Its `frame` tells where a value of x is, and which value is at a place.
 *
 * @type {(parts: Parts) => Figure}
 */
export function figure({
  title,
  x,
  y,
  cells = [],
  lines = [],
  points = [],
  stems = [],
  names = [],
  scale = null,
  colors = null,
  width = WIDTH,
  height = 300,
  heading = false,
  xRange = null,
  yRange = null,
  label = title,
}) {
  const named = [...lines, ...stems].flatMap(({ name, color = "", ...rest }) =>
    name ? [{ name, color, dash: "dash" in rest ? rest.dash : undefined }] : [],
  );
  const legend = named.length > 1 ? legendRows(named, width) : [];
  const frame = { ...FRAME, top: FRAME.top + (heading ? 18 : 0) + 15 * legend.length };
  let [left, right] =
    xRange ??
    range(
      [
        ...points.map((each) => each.x),
        ...lines.flatMap((line) => line.x),
        ...stems.flatMap((each) => each.x),
        ...cells.flatMap((each) => [each.x, each.x + each.width]),
      ],
      points.length ? 0.08 : 0,
    );
  const ys = [
    ...points.map((each) => each.y),
    ...lines.flatMap((line) => line.y.filter((value, i) => value !== null && line.x[i] >= left && line.x[i] <= right)),
    ...stems.flatMap((each) => [0, ...each.y]),
    ...cells.flatMap((each) => [each.y, each.y + each.height]),
  ];
  let [low, high] = yRange ?? range(ys, cells.length ? 0 : 0.08);
  if (stems.length) [left, low] = [0, yRange ? low : 0];
  /** @type {(value: number) => number} */
  const px = (value) => frame.left + ((value - left) / (right - left || 1)) * (width - frame.left - frame.right);
  /** @type {(value: number) => number} */
  const py = (value) => height - frame.bottom - ((value - low) / (high - low)) * (height - frame.top - frame.bottom);
  /** @type {Attributes} */
  const ink = colors ? { fill: colors.ink, "font-family": FONT, "font-size": LETTER } : {};
  /** @type {(attributes: Attributes, name: string) => SVGLineElement} */
  const line = (attributes, name) =>
    s("line", { ...attributes, class: name, ...(colors ? { stroke: colors.grid } : {}) });
  const svg = s("svg", {
    viewBox: `0 0 ${width} ${height}`,
    width: colors ? width : undefined,
    height: colors ? height : undefined,
    class: "scatter",
    role: points.some(({ open }) => open) ? "group" : "img",
    "aria-label": label,
    xmlns: "http://www.w3.org/2000/svg",
  });
  if (heading) svg.append(words(title, { ...ink, x: frame.left, y: 16, "font-weight": 600, "font-size": LETTER + 2 }));
  for (const { x: at, y: foot, width: wide, height: tall, color } of cells)
    svg.append(
      s("rect", {
        x: px(at).toFixed(2),
        y: py(foot + tall).toFixed(2),
        width: (px(at + wide) - px(at) + 0.3).toFixed(2),
        height: (py(foot) - py(foot + tall) + 0.3).toFixed(2),
        fill: color,
        "shape-rendering": "crispEdges",
      }),
    );
  for (const value of ticks(left, right)) {
    svg.append(
      line({ x1: px(value), x2: px(value), y1: frame.top, y2: height - frame.bottom }, "grid"),
      words(number(value), {
        ...ink,
        x: Math.min(px(value), width - 3.3 * number(value).length),
        y: height - frame.bottom + 16,
        "text-anchor": "middle",
      }),
    );
  }
  for (const value of ticks(low, high)) {
    svg.append(
      line({ x1: frame.left, x2: width - frame.right, y1: py(value), y2: py(value) }, "grid"),
      words(number(value, 6), { ...ink, x: frame.left - 6, y: py(value) + 4, "text-anchor": "end" }),
    );
  }
  svg.append(
    words(x, { ...ink, x: (frame.left + width - frame.right) / 2, y: height - 8, "text-anchor": "middle" }),
    words(y, {
      ...ink,
      transform: `translate(14 ${(frame.top + height - frame.bottom) / 2}) rotate(-90)`,
      "text-anchor": "middle",
    }),
  );
  legend.forEach((row, i) =>
    row.forEach(({ name, color, dash, at }) => {
      const level = frame.top - 15 * (legend.length - i) + 2;
      svg.append(
        s("line", {
          x1: frame.left + at,
          x2: frame.left + at + 22,
          y1: level,
          y2: level,
          stroke: color,
          "stroke-width": 2,
          "stroke-dasharray": dash?.length ? dash.join(" ") : null,
        }),
        words(name, { ...ink, x: frame.left + at + 27, y: level + 4 }),
      );
    }),
  );
  for (const each of lines)
    svg.append(
      s("path", {
        d: pathOf(each, px, py, [left, right]),
        fill: "none",
        class: each.parted ? "parted-line" : each.color ? undefined : "line",
        stroke: each.color,
        "stroke-width": each.width ?? 1.5,
        "stroke-dasharray": each.dash?.length ? each.dash.join(" ") : null,
      }),
    );
  stems.forEach((each, k) =>
    each.x.forEach((place, i) => {
      if (place < left || place > right) return;
      svg.append(
        s("line", {
          x1: px(place) + 2 * k,
          x2: px(place) + 2 * k,
          y1: py(low),
          y2: py(each.y[i]),
          stroke: each.color,
          "stroke-width": 1.5,
        }),
      );
    }),
  );
  for (const { label: name, x: at, y: level } of placedNames(names, {
    stems: stems.flatMap((each) => each.x.map((order, i) => ({ order, value: each.y[i] }))),
    px,
    py,
    left: frame.left,
    right: width - frame.right,
    letter: LETTER,
    widthOf: (text) => 6.6 * text.length,
  }))
    svg.append(words(name, { ...ink, x: at, y: level, "text-anchor": "middle" }));
  if (scale) svg.append(scaleAt(scale, width - frame.right, 8, ink));
  // Those that stand out are over the others.
  for (const point of [...points].sort((a, b) => Number(a.strong ?? false) - Number(b.strong ?? false))) {
    const dot = s("circle", {
      cx: px(point.x),
      cy: py(point.y),
      r: point.strong ? 5 : 3.2,
      class: point.strong ? "dot strong" : "dot",
    });
    const told = `${point.label}: ${number(point.x)}, ${number(point.y)}`;
    dot.append(Object.assign(s("title"), { textContent: told }));
    svg.append(dot);
    if (point.open) {
      dress(dot, {
        role: "button",
        tabindex: 0,
        "aria-label": `Open ${told}`,
        class: `${dot.getAttribute("class")} opens`,
        r: point.strong ? 7 : 5.5,
      });
      const { open } = point;
      dot.addEventListener("click", open);
      dot.addEventListener("keydown", (event) => {
        if (!["Enter", " "].includes(event.key)) return;
        event.preventDefault();
        open();
      });
    }
    if (point.strong) {
      const atEnd = px(point.x) > width * 0.75;
      const others = points.filter((other) => other !== point).map((other) => [px(other.x), py(other.y)]);
      svg.append(
        words(point.label, {
          x: px(point.x) + (atEnd ? -8 : 8),
          y: py(point.y) + (isFreeAbove(point.label, [px(point.x), py(point.y)], atEnd, others) ? -7 : 17),
          "text-anchor": atEnd ? "end" : "start",
          class: "name",
        }),
      );
    }
  }
  /** @type {Frame} */
  const placed = {
    x: [left, right],
    px,
    valueAt: (at) => left + ((at - frame.left) / (width - frame.left - frame.right)) * (right - left),
    top: frame.top,
    bottom: height - frame.bottom,
  };
  return Object.assign(svg, { frame: placed });
}

/**
 * Whether the name of a point at a place, which begins or ends there, covers none of the others where it stands above.
 *
 * @type {(name: string, at: number[], ends: boolean, others: number[][]) => boolean}
 */
function isFreeAbove(name, [x, y], ends, others) {
  const reach = 8 + 0.6 * LETTER * name.length;
  return !others.some(([x1, y1]) => {
    const along = ends ? x - x1 : x1 - x;
    return along > 0 && along < reach && y1 > y - 2 * LETTER && y1 < y;
  });
}

/**
 * A scale of colors that ends at a place, with what its ends mean.
 *
 * @type {(scale: { colors: string[], words: [string, string] }, right: number, y: number, ink: Attributes) =>
 *   SVGGElement}
 */
function scaleAt({ colors, words: [least, most] }, right, y, ink) {
  const step = 72 / colors.length;
  const left = right - 6.6 * most.length - 72 - 5;
  return s(
    "g",
    {},
    words(least, { ...ink, x: left - 5, y: y + 8, "text-anchor": "end" }),
    ...colors.map((color, i) => s("rect", { x: left + i * step, y, width: step + 0.3, height: 9, fill: color })),
    words(most, { ...ink, x: right, y: y + 8, "text-anchor": "end" }),
  );
}

/**
 * The names of lines in rows that fit.
 *
 * @type {(named: Named[], width: number) => (Named & { at: number })[][]}
 */
function legendRows(named, width) {
  /** @type {(Named & { at: number })[][]} */
  const rows = [[]];
  let at = 0;
  for (const each of named) {
    const length = 42 + 6.2 * each.name.length;
    if (at > 0 && at + length > width - FRAME.left - FRAME.right) {
      rows.push([]);
      at = 0;
    }
    rows[rows.length - 1].push({ ...each, at });
    at += length;
  }
  return rows;
}

/**
 * @type {(line: FigureLine, px: (value: number) => number, py: (value: number) => number, range: number[]) => string}
 */
function pathOf({ x, y }, px, py, [left, right]) {
  let pen = "M";
  let path = "";
  x.forEach((place, i) => {
    const value = y[i];
    if (value === null || value === undefined || place < left || place > right) {
      pen = "M";
      return;
    }
    path += `${pen}${px(place).toFixed(2)} ${py(value).toFixed(2)}`;
    pen = "L";
  });
  return path;
}

/**
 * A drawing as the text of a file.
 *
 * @type {(svg: SVGSVGElement) => string}
 */
export function fileOf(svg) {
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(svg)}`;
}

/**
 * Drawings below each other, as one.
 *
 * @type {(figures: SVGSVGElement[], background: string) => SVGSVGElement}
 */
export function stacked(figures, background) {
  const sizes = figures.map((each) => each.viewBox.baseVal);
  const [width, height] = [Math.max(...sizes.map((box) => box.width)), sizes.reduce((sum, box) => sum + box.height, 0)];
  const sheet = s(
    "svg",
    { viewBox: `0 0 ${width} ${height}`, width, height, xmlns: "http://www.w3.org/2000/svg" },
    s("rect", { width, height, fill: background }),
  );
  let y = 0;
  for (const [i, each] of figures.entries()) {
    dress(each, { y, width: sizes[i].width, height: sizes[i].height });
    y += sizes[i].height;
    sheet.append(each);
  }
  return sheet;
}

/** The height of the line that says what a picture shows. */
const CAPTION = 26;

/**
 * A drawing under a line that says what it shows.
 *
 * @type {(svg: SVGSVGElement, said: string, background: string) => SVGSVGElement}
 */
export function captioned(svg, said, background) {
  const [width, height] = ["width", "height"].map((name) => Number(svg.getAttribute(name)));
  dress(svg, { y: CAPTION });
  const ink = { "font-family": "system-ui, sans-serif", "font-size": 12, fill: "currentColor" };
  return s(
    "svg",
    {
      viewBox: `0 0 ${width} ${height + CAPTION}`,
      width,
      height: height + CAPTION,
      xmlns: "http://www.w3.org/2000/svg",
    },
    s("rect", { width, height: height + CAPTION, fill: background }),
    words(said, { ...ink, x: 10, y: 18 }),
    svg,
  );
}

/**
 * A drawing as a picture of so many pixels for each of its units.
 *
 * @type {(svg: SVGSVGElement, scale?: number) => Promise<Blob>}
 */
export async function pictureOf(svg, scale = 2) {
  const { width, height } = svg.viewBox.baseVal;
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(fileOf(svg))}`;
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), {
    width: Math.round(scale * width),
    height: Math.round(scale * height),
  });
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve, reject) =>
    canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("the picture is too large"))), "image/png"),
  );
}
