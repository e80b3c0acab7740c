// @ts-check
// A project as a document: the design that is worked on, the designs kept beside it as submissions, the work that was
// submitted for it, and notes.

/** @import { NamedDesign, Submission } from "./documents.js" */
/** @import { Known } from "./projects.js" */
/** @import { Submitted } from "./work.js" */

const FORMAT = "meshwright-project";
/** The version of documents that this page writes. It reads no later one. */
const VERSION = 1;

/** The number of characters that a name may have. */
export const LONGEST_NAME = 200;
/** The number of jobs and studies that a project keeps: the last ones. */
export const MOST_WORK = 100;

/**
 * A design that was kept: the submission, the one that was computed for it, and its name.
 *
 * @typedef {Pick<NamedDesign, "name" | "submission" | "asked"> & { hidden?: boolean }} KeptDesign
 */

/**
 * The contents of a project.
 *
 * @typedef {{ submission: Submission, typed: Record<string, number>, kept: KeptDesign[], work: Submitted[],
 *   notes: string, author: string, drawing: string }} Content
 */

/**
 * The state of a project over a reload: where it is kept, what was typed of it, its work, the designs that are not
 * computed yet, and the document that was saved.
 *
 * @typedef {{ known: Known | null, notes: string, author?: string, drawing?: string, work?: Submitted[],
 *   waiting: KeptDesign[], saved: object | null }} RememberedProject
 */

/** The reason why a document is not opened as a project. */
export class NoProject extends Error {}

/**
 * The document of a project.
 *
 * @param {Content} content
 */
export const documentOf = ({ submission, typed, kept, work, notes, author, drawing }) => ({
  format: FORMAT,
  version: VERSION,
  submission,
  typed,
  kept: kept.map(({ name, submission: own, asked, hidden }) => ({
    name,
    submission: own,
    asked,
    ...(hidden ? { hidden } : {}),
  })),
  work: work.slice(-MOST_WORK).map(({ id, kind, name, at }) => ({ id, kind, name, at })),
  notes,
  author,
  drawing_number: drawing,
});

/** @type {(value: unknown) => value is Record<string, any>} */
const isObject = (value) => typeof value === "object" && value !== null && !Array.isArray(value);

/** @type {(value: unknown) => value is Submission} */
const isSubmission = (value) => isObject(value) && isObject(value.pair);

/** @type {(kept: unknown) => boolean} */
const isKept = (kept) =>
  isObject(kept) && typeof kept.name === "string" && isSubmission(kept.submission) && isSubmission(kept.asked);

/** @type {Record<Submitted["kind"], true>} */
const KINDS = { job: true, sweep: true, sensitivity: true, study: true, search: true, population: true };

/** @type {(work: unknown) => boolean} */
const isWork = (work) =>
  isObject(work) &&
  /^[\w-]+$/.test(work.id) &&
  Object.hasOwn(KINDS, work.kind) &&
  typeof work.name === "string" &&
  !Number.isNaN(Date.parse(work.at));

/**
 * The content of a document.
 *
 * @param {unknown} document
 * @returns {Content}
 * @throws {NoProject} for a document of another program, of a later version, or without what a project has
 */
export function contentOf(document) {
  if (!isObject(document) || document.format !== FORMAT) throw new NoProject("This is no project of Meshwright.");
  // The first documents had no work, author and number.
  const { version, submission, typed, kept, work = [], notes, author = "", drawing_number: drawing = "" } = document;
  if (Number.isInteger(version) && version > VERSION)
    throw new NoProject(
      `A later Meshwright wrote this project (version ${version}; this page reads version ${VERSION}).`,
    );
  const isWhole =
    version === VERSION &&
    isSubmission(submission) &&
    isObject(typed) &&
    Object.values(typed).every((angle) => typeof angle === "number") &&
    Array.isArray(kept) &&
    kept.every(isKept) &&
    Array.isArray(work) &&
    work.every(isWork) &&
    [notes, author, drawing].every((words) => typeof words === "string");
  if (!isWhole) throw new NoProject("The project is damaged: parts of it are missing or are not what they should be.");
  return { submission, typed, kept, work, notes, author, drawing };
}

/**
 * The checksum of a text: CRC-32, in hexadecimal.
 *
 * @type {(text: string) => string}
 */
function checksum(text) {
  let crc = 0xffffffff;
  for (const byte of new TextEncoder().encode(text)) {
    crc ^= byte;
    for (let bit = 0; bit < 8; bit += 1) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  }
  return (~crc >>> 0).toString(16).padStart(8, "0");
}

/**
 * A project as the text of a file.
 *
 * @type {(name: string, document: object) => string}
 */
export const fileOf = (name, document) =>
  `${JSON.stringify({ format: `${FORMAT}-file`, version: VERSION, name, checksum: checksum(JSON.stringify([name, document])), document })}\n`;

/**
 * The project of a file.
 *
 * @param {string} text
 * @returns {{ name: string, content: Content }}
 * @throws {NoProject}
 */
export function projectOf(text) {
  /** @type {unknown} */
  let file;
  try {
    file = JSON.parse(text);
  } catch {
    const isCut = text.startsWith(`{"format":"${FORMAT}-file"`);
    throw new NoProject(isCut ? "The file is damaged: it is cut off." : "This is no project of Meshwright.");
  }
  if (!isObject(file) || file.format !== `${FORMAT}-file`) throw new NoProject("This is no project of Meshwright.");
  const { name, document } = file;
  // A later version may write other files: that is told before anything of them is judged.
  if (Number.isInteger(file.version) && file.version > VERSION) contentOf({ format: FORMAT, version: file.version });
  if (!isName(name) || file.checksum !== checksum(JSON.stringify([name, document])))
    throw new NoProject("The file is damaged: it is not what was saved.");
  return { name, content: contentOf(document) };
}

/**
 * Whether a project may be called so.
 *
 * @type {(name: unknown) => name is string}
 */
export const isName = (name) =>
  typeof name === "string" &&
  name.trim() !== "" &&
  [...name].length <= LONGEST_NAME &&
  // Control characters.
  !/\p{Cc}/u.test(name);
