// Elements of the page.

export const $ = (id) => document.getElementById(id);

/** Say what is wrong beside the control of this name, or no longer. */
export function explainBeside(name, problem) {
  const message = $(`problem-${name}`);
  message.textContent = problem;
  message.hidden = !problem;
}

/** A new element with these properties and children. */
export function element(tag, properties, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}
