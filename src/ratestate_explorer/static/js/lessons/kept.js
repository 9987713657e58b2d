// What the browser keeps while the page's tab is open, as JSON.

export function keep(key, value) {
  try {
    sessionStorage.setItem(key, JSON.stringify(value));
  } catch {
    // A browser that keeps nothing: then it lasts as long as the page.
  }
}

/** What was kept; null if nothing was. */
export function recall(key) {
  try {
    return JSON.parse(sessionStorage.getItem(key));
  } catch {
    return null;
  }
}
