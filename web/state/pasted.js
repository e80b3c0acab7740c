// @ts-check
// A report or a table as text: lines that name a field in German or English, with a value for each gear or one for the
// pair. What is not understood is told.

/** @import { Submission } from "./documents.js" */

/**
 * The content of a line: the field, and its values for the driving and for the driven gear, or one for the pair.
 *
 * @typedef {{ field: string, title: string, values: (number | string)[], line: string }} Taken
 */

/** @typedef {{ taken: Taken[], left: string[], decimal: "." | "," }} Pasted */

/**
 * A field that may be pasted: how lines name it after they have been made plain, symbols that stand for it, what its
 * name may not have, and whether it is of the pair.
 *
 * @typedef {{ field: string, title: string, named: RegExp, symbols: string[], but?: RegExp, ofPair?: boolean,
 *   isText?: boolean }} Known
 */

/** Words of sizes that are not nominal, or are measured on another circle or section. */
const NOT_NOMINAL =
  /allowance|abmass|tolerance|toleranz|deviation|abweichung|upper|lower|oberes|unteres|minimum|maximum|effektiv|effective|actual|istmass|\bsum\b|summe/;

/** @type {Known[]} */
const KNOWN = [
  {
    field: "tooth_count",
    title: "Number of teeth",
    named: /^(number of )?teeth$|zaehnezahl|number of teeth/,
    symbols: ["z"],
    but: /spann|mess|virtual|ersatz|ueber/,
  },
  {
    field: "module_mm",
    title: "Module",
    named: /\bmodule?\b|normalmodul/,
    symbols: ["mn", "m"],
    but: /transverse|stirn|young|elastic|e-modul|axial/,
    ofPair: true,
  },
  {
    field: "pressure_angle_deg",
    title: "Pressure angle",
    named: /pressure angle|eingriffswinkel/,
    symbols: ["alfn", "alphan", "αn", "alpha", "α"],
    but: /working|betrieb|transverse|stirn|operating|tip|kopf/,
    ofPair: true,
  },
  {
    field: "helix_angle_deg",
    title: "Helix angle",
    named: /helix angle|schraegungswinkel/,
    symbols: ["beta", "β"],
    but: /base|grund|working|betrieb/,
    ofPair: true,
  },
  {
    field: "hand",
    title: "Hand of helix",
    named: /hand of (the )?(helix|gear)|helix (hand|direction)|schraegungsrichtung|flankenrichtung/,
    symbols: [],
    isText: true,
  },
  {
    field: "center_distance_mm",
    title: "Center distance",
    named: /cent(er|re) distance|achsabstand/,
    symbols: ["a", "aw"],
    but: /reference|\bnull|ohne|zero/,
    ofPair: true,
  },
  {
    field: "profile_shift",
    title: "Profile shift coefficient",
    named: /profile shift( coefficient)?|profilverschiebung(sfaktor)?/,
    symbols: ["x", "x*"],
    but: /generating|erzeugung|herstell|manufactur/,
  },
  {
    field: "face_width_mm",
    title: "Face width",
    named: /face ?width|zahnbreite/,
    symbols: ["b"],
    but: /common|gemeinsam/,
  },
  {
    field: "tip_diameter_mm",
    title: "Tip diameter",
    named: /tip (circle )?diameter|kopfkreis(durchmesser)?/,
    symbols: ["da"],
    but: /form|active|nutz|tip form/,
  },
  {
    field: "root_diameter_mm",
    title: "Root diameter",
    named: /root (circle )?diameter|fusskreis(durchmesser)?/,
    symbols: ["df"],
    but: /form|active|nutz/,
  },
  {
    field: "addendum",
    title: "Addendum coefficient of the basic rack",
    named: /addendum (coefficient|factor)|kopfhoehenfaktor/,
    symbols: ["hap*", "hap"],
  },
  {
    field: "dedendum",
    title: "Dedendum coefficient of the basic rack",
    named: /dedendum (coefficient|factor)|fusshoehenfaktor/,
    symbols: ["hfp*", "hfp"],
  },
  {
    field: "rack_tip_radius",
    title: "Root radius factor of the basic rack",
    named: /root radius (coefficient|factor)|fussradiusfaktor|fussrundung/,
    symbols: ["rhofp*", "rhofp", "ρfp*"],
  },
  {
    field: "bore_diameter_mm",
    title: "Bore",
    named: /\bbore\b|bohrung|inner diameter|inside diameter|innendurchmesser/,
    symbols: ["di"],
  },
  {
    field: "speed_rpm",
    title: "Speed",
    named: /\bspeed\b|drehzahl/,
    symbols: ["n"],
    but: /pitch line|umfang|sliding|resonan/,
  },
  { field: "torque_n_m", title: "Torque", named: /\btorque\b|drehmoment/, symbols: ["t"] },
  { field: "power_kw", title: "Power", named: /\bpower\b|leistung/, symbols: ["p"], ofPair: true, but: /loss|verlust/ },
  { field: "material", title: "Material", named: /^(material|werkstoff)$/, symbols: [], isText: true },
  {
    field: "youngs_modulus",
    title: "Young's modulus",
    named: /young'?s modulus|e-modul|elastizitaetsmodul/,
    symbols: ["e"],
  },
  { field: "poisson_ratio", title: "Poisson's ratio", named: /poisson|querkontraktion/, symbols: ["nu", "ν", "ny"] },
  { field: "density_kg_m3", title: "Density", named: /density|dichte/, symbols: ["rho", "ρ"] },
];

/**
 * Words as they are compared: small, without umlauts and accents.
 *
 * @type {(words: string) => string}
 */
const plain = (words) =>
  words
    .toLowerCase()
    .replace(/ä/g, "ae")
    .replace(/ö/g, "oe")
    .replace(/ü/g, "ue")
    .replace(/ß/g, "ss")
    .replace(/’/g, "'")
    .trim();

/**
 * A symbol as it is compared: without its index line.
 *
 * @type {(word: string) => string}
 */
const symbolOf = (word) => plain(word).replace(/[_\s]/g, "");

const NUMBER = /[+-]?(?:\d[\d.,]*|[.,]\d+)(?:e[+-]?\d+)?/i;
const ALONE = new RegExp(`^${NUMBER.source}$`, "i");
/** Units that may stand behind values, by themselves. */
const UNIT =
  /^[[(]?(mm|µm|um|°|deg|grad|nm|n\s?m|n·m|rpm|1\/min|min-1|u\/min|kw|gpa|mpa|n\/mm[²2]|kg\/m[³3]|g\/cm[³3]|-)[\])]?$/i;

/**
 * The sign before the decimals in a text: what no number with a sign between thousands can have tells it.
 *
 * @type {(text: string) => "." | ","}
 */
function decimalOf(text) {
  /** @type {(sign: string) => number} */
  const count = (sign) =>
    [...text.matchAll(new RegExp(`\\d\\${sign}(\\d{1,2}|\\d{4,})(?!\\d)|\\b0\\${sign}\\d`, "g"))].length;
  return count(",") > count(".") ? "," : ".";
}

/** @type {(word: string, decimal: "." | ",") => number} */
const numberOf = (word, decimal) =>
  Number(decimal === "," ? word.replace(/\./g, "").replace(",", ".") : word.replace(/,(?=\d{3}(?!\d))/g, ""));

/**
 * The cells of a line: what stands apart by tabs, semicolons, bars or two spaces.
 *
 * @type {(line: string) => string[]}
 */
const cellsOf = (line) =>
  line
    .replace(/\.{3,}|[:=]\s/g, "  ")
    .split(/\t|;|\||\s{2,}/)
    .map((cell) => cell.trim())
    .filter(Boolean);

/**
 * The name of a line, its symbol and unit, and its values. Null where a line has no name.
 *
 * @param {string} line
 */
function partsOf(line) {
  const cells = cellsOf(line);
  const [first, ...rest] = cells;
  if (!first || ALONE.test(first)) return null;
  // A line of single spaces: the values stand at its end.
  const words = rest.length ? cells : first.split(/\s+/);
  const at = words.findIndex((word, i) => i > 0 && ALONE.test(word));
  const named = at < 0 ? cells.slice(0, 1) : words.slice(0, at);
  const behind = at < 0 ? rest : words.slice(at);
  const name = named.join(" ");
  const brackets = [...name.matchAll(/[[(]([^\])]*)[\])]/g)].map(([, inside]) => inside.trim());
  const bare = name.replace(/[[(][^\])]*[\])]/g, " ").trim();
  const isUnit = (/** @type {string} */ word) => UNIT.test(word);
  const unit = [...brackets, ...behind, ...named.slice(1)].find(isUnit) ?? "";
  const isUnitless = brackets.filter((word) => !isUnit(word));
  // A name of one word may be a symbol.
  const marks = [...isUnitless, ...bare.split(/[\s,]+/)].map(symbolOf);
  const symbols = /\s/.test(bare) ? isUnitless.map(symbolOf) : marks;
  return {
    name: plain(bare),
    symbols,
    gear: gearOf(plain(bare), marks),
    unit: plain(unit).replace(/[[\]()\s]/g, ""),
    values: behind.filter((word) => !isUnit(word)),
  };
}

/**
 * The field that a line names: by its words, or else by a symbol that stands alone or in brackets.
 *
 * @type {(name: string, symbols: string[]) => Known | undefined}
 */
function fieldOf(name, symbols) {
  if (NOT_NOMINAL.test(name)) return undefined;
  /** @type {(known: Known) => boolean} */
  const allowed = ({ but }) => !but?.test(name);
  const byName = KNOWN.find((known) => known.named.test(name) && allowed(known));
  if (byName || KNOWN.some(({ named }) => named.test(name))) return byName;
  // A symbol with an index is that of one gear.
  return KNOWN.find(
    (known) => allowed(known) && symbols.some((symbol) => known.symbols.includes(symbol.replace(/[12]$/, ""))),
  );
}

/**
 * The number of the gear that a name or a symbol tells, 1 or 2; undefined where they tell none.
 *
 * @type {(name: string, symbols: string[]) => number | undefined}
 */
function gearOf(name, symbols) {
  const index = symbols.map((symbol) => /^[a-zαβρν]{1,5}\*?([12])$/.exec(symbol)?.[1]).find(Boolean);
  const said = /\b(?:gear|rad) ?([12])\b/.exec(name)?.[1] ?? index;
  return said ? Number(said) : undefined;
}

const [ONE, OTHER] = [
  /ritzel|pinion|driving|treibend|(gear|rad) ?1/,
  /\brad\b(?! ?1)|wheel|driven|getrieben|(gear|rad) ?2/,
];

/**
 * Reads a text. `decimal` is the sign before the decimals, where somebody has said it.
 *
 * @type {(text: string, decimal?: "." | "," | null) => Pasted}
 */
export function read(text, decimal = null) {
  const sign = decimal ?? decimalOf(text);
  /** @type {Map<string, Taken>} */
  const taken = new Map();
  /** @type {string[]} */
  const left = [];
  let isSwapped = false;
  const lines = text.replace(/\u2212/g, "-").split(/\r?\n/);
  for (const line of lines.filter((each) => each.trim())) {
    const words = plain(line);
    if (!NUMBER.test(line) || /(gear|rad) ?[12]/.test(words)) {
      const [one, other] = [words.search(ONE), words.search(OTHER)];
      if (one >= 0 && other >= 0) {
        isSwapped = other < one;
        continue;
      }
    }
    const parts = partsOf(line);
    const known = parts && fieldOf(parts.name, parts.symbols);
    const found = parts && known && valuesOf(parts, known, sign);
    if (!parts || !known || !found) {
      left.push(line.trim());
      continue;
    }
    const { field, title } = known;
    const before = taken.get(field);
    const { gear } = parts;
    const values = isSwapped && found.length === 2 ? found.toReversed() : found;
    if (gear && values.length === 1) {
      const both = before?.values.length === 2 ? [...before.values] : [NaN, NaN];
      both[gear - 1] = values[0];
      taken.set(field, { field, title, values: both, line: [before?.line, line.trim()].filter(Boolean).join("; ") });
      // What a report prints first of a field is the nominal one.
    } else if (before) left.push(line.trim());
    else taken.set(field, { field, title, values, line: line.trim() });
  }
  return {
    taken: [...taken.values()].filter(({ values }) => values.some((value) => !Number.isNaN(value))),
    left,
    decimal: sign,
  };
}

/**
 * The values of a line in the units of the fields; null where they are none of its field.
 *
 * @param {{ values: string[], unit: string }} parts
 * @param {Known} known
 * @param {"." | ","} decimal
 * @returns {(number | string)[] | null}
 */
function valuesOf({ values, unit }, { field, isText }, decimal) {
  if (!values.length || values.length > 2) return null;
  if (isText) return values;
  const numbers = values.map((value) => (ALONE.test(value) ? numberOf(value, decimal) : NaN));
  if (numbers.some((value) => !Number.isFinite(value))) return null;
  return numbers.map((value) => inUnit(value, field, unit));
}

/** @type {(value: number, field: string, unit: string) => number} */
function inUnit(value, field, unit) {
  // A modulus above that of diamond in GPa is one in MPa.
  const isSmallUnit = /mpa|n\/mm/.test(unit) || (field === "youngs_modulus" && unit === "" && value > 1200);
  if (field === "youngs_modulus" && isSmallUnit) return value / 1000;
  if (field === "density_kg_m3" && (/g\/cm/.test(unit) || value < 30)) return value * 1000;
  if (field === "torque_n_m" && unit === "nmm") return value / 1000;
  return value;
}

const GEARS = ["driving", "driven"];
/** Fields of a gear that take the place of each other, the ones of a report before those of a tool. */
const INSTEAD = [
  ["tip_diameter_mm", "addendum"],
  ["root_diameter_mm", "dedendum"],
];
/** Coefficients of the module, and their fields. */
const OF_MODULE = { addendum: "addendum_mm", dedendum: "dedendum_mm", rack_tip_radius: "rack_tip_radius_mm" };

/**
 * The fields of a submission that were pasted, by their pointers; undefined takes a field away. `base` has what was
 * not, and `materialOf` finds the name of a material.
 *
 * @type {(pasted: Pasted, base: Submission, materialOf: (words: string) => string | undefined) =>
 *   Record<string, unknown>}
 */
export function valuesOfPasted({ taken }, base, materialOf) {
  const by = new Map(taken.map(({ field, values }) => [field, values]));
  /** @type {Record<string, unknown>} */
  const found = {};
  /** @type {(field: string, i: number) => any} */
  const of = (field, i) => {
    const values = by.get(field);
    const value = values?.[Math.min(i, values.length - 1)];
    return typeof value === "number" && Number.isNaN(value) ? undefined : value;
  };
  GEARS.forEach((gear, i) => {
    const place = `/pair/${gear}`;
    const module = of("module_mm", i) ?? base.pair[i ? "driven" : "driving"].module_mm;
    for (const name of [
      "tooth_count",
      "module_mm",
      "pressure_angle_deg",
      "profile_shift",
      "face_width_mm",
      "tip_diameter_mm",
      "root_diameter_mm",
    ])
      if (of(name, i) !== undefined) found[`${place}/${name}`] = of(name, i);
    for (const [name, field] of Object.entries(OF_MODULE))
      if (of(name, i) !== undefined) found[`${place}/${field}`] = Number((of(name, i) * module).toPrecision(9));
    // The height of a tool stays where the report gives no diameter.
    for (const [diameter, height] of INSTEAD)
      if (of(diameter, i) !== undefined) found[`${place}/${height}_mm`] = undefined;
    if (of("bore_diameter_mm", i) !== undefined) found[`${place}/blank/bore_radius_mm`] = of("bore_diameter_mm", i) / 2;
    const material = materialOf(String(of("material", i) ?? ""));
    if (material) found[`${place}/material/name`] = material;
    for (const [name, field] of [
      ["youngs_modulus", "youngs_modulus_gpa"],
      ["poisson_ratio", "poisson_ratio"],
      ["density_kg_m3", "density_kg_m3"],
    ])
      if (of(name, i) !== undefined) found[`${place}/material/${field}`] = of(name, i);
  });
  if (of("center_distance_mm", 0) !== undefined) found["/pair/center_distance_mm"] = of("center_distance_mm", 0);
  const helix = of("helix_angle_deg", 0);
  if (helix !== undefined) {
    const isLeft = /^(l|links|left)/.test(plain(String(of("hand", 0) ?? "")));
    found["/pair/helix_angle_deg"] = isLeft ? -Math.abs(helix) : helix;
    if (helix && !base.method.startsWith("three_dimensional")) found["/method"] = "three_dimensional";
  }
  if (of("speed_rpm", 0) !== undefined) found["/driving_speed_rpm"] = of("speed_rpm", 0);
  const torque = outputTorque(by, (i) => of("tooth_count", i) ?? base.pair[i ? "driven" : "driving"].tooth_count, of);
  if (torque !== undefined) found["/output_torques_n_m"] = [Number(torque.toPrecision(6))];
  return found;
}

/**
 * The torque on the driven gear: that of the second gear, or by the ratio from that of the first or from power and
 * speed.
 *
 * @param {Map<string, (number | string)[]>} by
 * @param {(i: number) => number} teeth
 * @param {(field: string, i: number) => any} of
 * @returns {number | undefined}
 */
function outputTorque(by, teeth, of) {
  const ratio = teeth(1) / teeth(0);
  const [one, two] = [of("torque_n_m", 0), by.get("torque_n_m")?.length === 2 ? of("torque_n_m", 1) : undefined];
  if (two !== undefined) return Math.abs(two);
  if (one !== undefined) return Math.abs(one) * ratio;
  const [power, speed] = [of("power_kw", 0), of("speed_rpm", 0)];
  return power && speed ? ((1000 * power) / ((2 * Math.PI * speed) / 60)) * ratio : undefined;
}
