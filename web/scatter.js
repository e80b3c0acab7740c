// A small chart of points or of one curve, as a drawing that readers of screens can follow.

import { s, number } from "./dom.js";

const [WIDTH, HEIGHT] = [520, 300];
const FRAME = { left: 62, right: 14, top: 14, bottom: 44 };

/** Five or so round numbers between two. */
function ticks(low, high) {
  const raw = (high - low) / 5 || 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((each) => each * power >= raw) * power;
  const found = [];
  for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + step * 1e-9; value += step) found.push(value);
  return found;
}

function range(values) {
  const [least, most] = [Math.min(...values), Math.max(...values)];
  const room = (most - least || Math.abs(most) || 1) * 0.08;
  return [least - room, most + room];
}

/** Points `{ x, y, label, strong }` over named axes; joined by a line if `line`. */
export function scatter({ points, x, y, title, line = false }) {
  const [left, right] = range(points.map((point) => point.x));
  const [low, high] = range(points.map((point) => point.y));
  const px = (value) => FRAME.left + ((value - left) / (right - left)) * (WIDTH - FRAME.left - FRAME.right);
  const py = (value) => HEIGHT - FRAME.bottom - ((value - low) / (high - low)) * (HEIGHT - FRAME.top - FRAME.bottom);
  const words = (text, attributes) => Object.assign(s("text", attributes), { textContent: text });
  const svg = s("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "scatter", role: "img", "aria-label": title });
  for (const value of ticks(left, right)) {
    svg.append(s("line", { x1: px(value), x2: px(value), y1: FRAME.top, y2: HEIGHT - FRAME.bottom, class: "grid" }), words(number(value), { x: px(value), y: HEIGHT - FRAME.bottom + 16, "text-anchor": "middle" }));
  }
  for (const value of ticks(low, high)) {
    svg.append(s("line", { x1: FRAME.left, x2: WIDTH - FRAME.right, y1: py(value), y2: py(value), class: "grid" }), words(number(value), { x: FRAME.left - 6, y: py(value) + 4, "text-anchor": "end" }));
  }
  svg.append(words(x, { x: (FRAME.left + WIDTH - FRAME.right) / 2, y: HEIGHT - 8, "text-anchor": "middle" }), words(y, { transform: `translate(14 ${(FRAME.top + HEIGHT - FRAME.bottom) / 2}) rotate(-90)`, "text-anchor": "middle" }));
  if (line) svg.append(s("path", { d: `M${points.map((point) => `${px(point.x)} ${py(point.y)}`).join("L")}`, class: "line" }));
  for (const point of points) {
    const dot = s("circle", { cx: px(point.x), cy: py(point.y), r: point.strong ? 5 : 3.2, class: point.strong ? "dot strong" : "dot" });
    dot.append(Object.assign(s("title"), { textContent: `${point.label}: ${number(point.x)}, ${number(point.y)}` }));
    svg.append(dot);
    if (point.strong) {
      const atEnd = px(point.x) > WIDTH * 0.75;
      svg.append(words(point.label, { x: px(point.x) + (atEnd ? -8 : 8), y: py(point.y) - 7, "text-anchor": atEnd ? "end" : "start", class: "name" }));
    }
  }
  return svg;
}
