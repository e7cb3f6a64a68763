// What runs when the page is there: a player is set up when it comes near the screen.

function whenNear(element, action) {
  const watch = new IntersectionObserver((seen) => {
    if (!seen.some((entry) => entry.isIntersecting)) return;
    watch.disconnect();
    action();
  }, { rootMargin: "600px" });
  watch.observe(element);
}

const redraws = [];

for (const [id, start] of [["watch", startPlayer], ["try", startLive]]) {
  const root = document.querySelector(`#${id} [data-part="stage"]`);
  if (root) whenNear(root, () => redraws.push(start(root)));
}

const redraw = () => redraws.forEach((draw) => draw());
window.addEventListener("resize", redraw);
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);

window.bcre = { fold, step, stableStep, excessOfAutomaton, excessOfBcre, fittedSlope, unpacked };
