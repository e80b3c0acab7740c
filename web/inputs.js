// What is typed into a control, as a value of the design, and back.

/** The value in a control; undefined where there is none, and what is no number as it stands, for the service to refuse. */
export function read(input, kind) {
  const text = input.value.trim();
  if (text === "") return undefined;
  if (kind.kind === "numbers") return text.split(/[\s,;]+/).filter(Boolean).map((word) => (Number.isNaN(Number(word)) ? word : Number(word)));
  if (kind.kind === "texts") return text.split(",").map((word) => word.trim()).filter(Boolean);
  // A comma for a decimal point, as half of Europe writes it.
  return kind.kind === "number" ? Number(text.replace(",", ".")) : text;
}

/** The value of a text that may be JSON. */
export function parsed(text) {
  if (text.trim() === "") return undefined;
  try {
    return JSON.parse(text);
  } catch {
    return text;
  }
}

/** Shows a value in a control; where there is none, what it is then. */
export function write(input, kind, value) {
  if (kind.kind === "flag") input.checked = value ?? kind.schema.default ?? false;
  else if (kind.kind === "choice") input.value = value ?? kind.schema.default ?? kind.schema.enum[0];
  else if (value === undefined || value === null) input.value = "";
  else if (Array.isArray(value)) input.value = value.join(", ");
  else input.value = typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** A number so many steps on, each a tenth of its leading digit, within its bounds. */
export function stepped(value, steps, kind) {
  const { minimum = -Infinity, maximum = Infinity } = kind.schema;
  const size = kind.whole ? 1 : 10 ** Math.floor(Math.log10(Math.max(Math.abs(value), 0.1)) - 1);
  return Math.min(maximum, Math.max(minimum, Number((Math.round(value / size + steps) * size).toPrecision(8))));
}
