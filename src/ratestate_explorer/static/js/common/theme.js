// The style sheet's colours, for canvases.

const dark = matchMedia("(prefers-color-scheme: dark)");
let known = null;

/** Colour of a role, such as "accent": what --accent is in css/theme.css. */
export function color(role) {
  known ??= getComputedStyle(document.documentElement);
  return known.getPropertyValue(`--${role}`).trim();
}

export const FONT = 'system-ui, -apple-system, "Segoe UI", "Noto Sans", "DejaVu Sans", sans-serif';

/** Call when light turns to dark, or back. */
export function onTheme(call) {
  dark.addEventListener("change", () => {
    known = null;
    call();
  });
}
