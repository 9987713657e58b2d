// A dot on a chart that is dragged, and moved by keys; a click elsewhere on the chart brings it there.

const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const FAR = 10; // with Shift, in steps

export class Handle {
  /**
   * canvas, dot: the chart, and the button over the dot that is drawn on it
   * on: {isUsable(), drag(x, y of the canvas, event's time stamp), step([right, up] in steps, time stamp)}
   */
  constructor(canvas, dot, on) {
    Object.assign(this, { canvas, dot, on, isDragging: false });
    const box = canvas.parentElement;
    box.addEventListener("pointerdown", (event) => this.grasp(event));
    box.addEventListener("pointermove", (event) => this.isDragging && this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) box.addEventListener(end, () => (this.isDragging = false));
    dot.addEventListener("keydown", (event) => this.press(event));
  }

  grasp(event) {
    if (!this.on.isUsable() || event.button !== 0 || ![this.canvas, this.dot].includes(event.target)) return;
    // A finger elsewhere wants to scroll the page.
    if (event.pointerType === "touch" && event.target !== this.dot) return;
    event.preventDefault();
    this.canvas.parentElement.setPointerCapture(event.pointerId);
    this.dot.focus({ focusVisible: false });
    this.isDragging = true;
    this.drag(event);
  }

  drag(event) {
    const { left, top } = this.canvas.getBoundingClientRect();
    this.on.drag(event.clientX - left, event.clientY - top, event.timeStamp);
  }

  press(event) {
    const way = WAYS[event.key];
    if (!way || !this.on.isUsable()) return;
    event.preventDefault();
    this.on.step(way.map((steps) => steps * (event.shiftKey ? FAR : 1)), event.timeStamp);
  }

  /** Put the button over the dot. */
  put(x, y) {
    this.dot.style.left = `${x}px`;
    this.dot.style.top = `${y}px`;
  }
}
