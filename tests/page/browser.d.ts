// What the steps use in the browser. What a selector finds is held by the steps themselves.

interface ParentNode {
  querySelector(selector: string): any;
  querySelectorAll(selector: string): any;
}

interface Element {
  closest(selector: string): any;
}

interface Document {
  getElementById(id: string): any;
  activeElement: any;
}

interface Window {
  /** What a step has put there to look at it later. */
  [noted: string]: any;
}
