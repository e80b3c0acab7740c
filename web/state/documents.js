// @ts-check
// The documents of the service as types, made of its contract. A browser never fetches this module.

/** @typedef {import("meshwright").components["schemas"]} Schemas */

/** @typedef {import("meshwright").paths} Paths */

/**
 * The JSON of an answer.
 *
 * @template R
 * @typedef {R extends { 200: { content: { "application/json": infer T } } } ? T
 *   : R extends { 202: { content: { "application/json": infer T } } } ? T : any} JsonOf
 */

/**
 * What the contract says of the answer at a path, as far as the path is no more than a text that stands in it.
 *
 * @template {string} P
 * @template {"get" | "post"} M
 * @typedef {`/${P}` extends keyof Paths
 *   ? Paths[`/${P}`][M] extends { responses: infer R } ? JsonOf<R> : any : any} AnswerAt
 */

/** @typedef {Schemas["Submission"]} Submission */
/** @typedef {Submission["method"]} Method */
/** @typedef {Schemas["Gear"]} Gear */
/** @typedef {Schemas["GearName"]} GearName */
/** @typedef {Schemas["Blank"]} Blank */
/** @typedef {Schemas["Holes"]} Holes */
/** @typedef {Schemas["Pair"]} Pair */
/** @typedef {Schemas["Results"]} Results */
/** @typedef {Schemas["Curve"]} Curve */
/** @typedef {Schemas["Spectrum"]} Spectrum */
/** @typedef {Schemas["NamedOrder"]} NamedOrder */
/** @typedef {Schemas["Face"]} Face */
/** @typedef {Schemas["Dynamics"]} Dynamics */
/** @typedef {Schemas["RunUpBranch"]} RunUpBranch */
/** @typedef {Schemas["LeadModification"]} LeadModification */
/** @typedef {Schemas["ForceTable"]} ForceTable */
/** @typedef {NonNullable<Holes["slot"]>} Slot */
/** @typedef {Schemas["LoadedEdges"]} LoadedEdges */
/** @typedef {Schemas["PairOutline"]} PairOutline */
/** @typedef {Schemas["GearOutline"]} GearOutline */
/** @typedef {Schemas["ContactPattern"]} ContactPattern */
/** @typedef {Schemas["PatternCurve"]} PatternCurve */
/** @typedef {Schemas["Job"]} Job */
/** @typedef {Schemas["Study"]} Study */
/** @typedef {Schemas["StudyList"]["items"][number]} StudyState */
/** @typedef {Schemas["StudyResults"]} StudyResults */
/** @typedef {Schemas["PopulationResults"]} PopulationResults */
/** @typedef {Schemas["QuantityResults"]} QuantityResults */
/** @typedef {Schemas["Percentile"]} Percentile */
/** @typedef {Schemas["SearchProgress"]} SearchProgress */
/** @typedef {Schemas["FoundDesign"]} FoundDesign */
/** @typedef {Schemas["Search"]} Search */

/**
 * A study as the page asks for it: of a whole design.
 *
 * @typedef {Study & { base: Submission }} AskedStudy
 */

/** @typedef {AskedStudy & { search: Search }} AskedSearch */

/**
 * What opens a submission as a design, with its results where they are known.
 *
 * @typedef {(submission: Submission, results: Results | null) => unknown} Open
 */

/** @typedef {Schemas["TableRow"]} TableRow */
/** @typedef {Schemas["RowCurve"]} RowCurve */
/** @typedef {Schemas["Limits"]} Limits */
/** @typedef {Schemas["Example"]} Example */
/** @typedef {Schemas["RexsModel"]} RexsModel */
/** @typedef {Schemas["Status"]} Status */
/** @typedef {Schemas["Warning"]} Warning */
/** @typedef {Schemas["FieldError"]} FieldError */

/**
 * A problem: one that the service answers, or one that the page itself finds, which has only what it shows.
 *
 * @typedef {{ code?: string, title?: string, detail?: string, status?: number, errors?: FieldError[] }} Problem
 */

/**
 * A design with its results under a name: `asked` is the submission that the results are of, `look` its number among
 * the designs on the screen, `teeth` the number of teeth of its driven gear.
 *
 * @typedef {{ name: string, results: Results, submission: Submission, asked: Submission, teeth: number, look: number,
 *   hidden?: boolean }} NamedDesign
 */

export {};
