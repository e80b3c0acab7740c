// @ts-check
// What this tab works on, over a reload: the kept designs with their results, and the way back from every change.

/** @import { Remembered } from "./design.js" */

const NAME = "meshwright";
const TABS = "tabs";
/** What a tab is called in the store; a tab keeps its name over a reload. */
const PLACE = "meshwright-tab";
/** Tabs that nobody has worked in for so long are forgotten, in milliseconds. */
const LONG = 14 * 24 * 3600_000;

const tab = (() => {
  const known = sessionStorage.getItem(PLACE) ?? crypto.getRandomValues(new Uint32Array(3)).join("-");
  sessionStorage.setItem(PLACE, known);
  return known;
})();

/**
 * @template T
 * @param {IDBRequest<T>} request
 * @returns {Promise<T>}
 */
const done = (request) =>
  new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });

/** @type {Promise<IDBDatabase> | null} */
let opened = null;

/** @type {(mode: IDBTransactionMode) => Promise<IDBObjectStore>} */
async function store(mode) {
  if (!opened) {
    const request = indexedDB.open(NAME, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(TABS);
    opened = done(request);
  }
  return (await opened).transaction(TABS, mode).objectStore(TABS);
}

/**
 * Remembers what is worked on, `state`, which has results of designs by reference: they are stored once.
 *
 * @type {(state: Remembered) => Promise<void>}
 */
export async function remember(state) {
  try {
    await done((await store("readwrite")).put({ ...state, at: Date.now() }, tab));
  } catch {
    // No room, or not allowed: it lasts as long as the page.
  }
}

/**
 * What was remembered; null where nothing was.
 *
 * @type {() => Promise<Remembered | null>}
 */
export async function remembered() {
  try {
    const all = await store("readwrite");
    const known = await done(all.get(tab));
    const cursor = all.openCursor();
    cursor.onsuccess = () => {
      if (!cursor.result) return;
      if (Date.now() - cursor.result.value.at > LONG) cursor.result.delete();
      cursor.result.continue();
    };
    return known ?? null;
  } catch {
    return null;
  }
}
