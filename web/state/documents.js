// @ts-check
// The documents of the service as types, made of its contract. A browser never fetches this module.

/** @typedef {import("meshwright").components["schemas"]} Schemas */
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
