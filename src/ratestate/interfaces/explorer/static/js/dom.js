// Elements of the page.

export const $ = (id) => document.getElementById(id);

/** A new element with these properties and children. */
export function element(tag, properties, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}
