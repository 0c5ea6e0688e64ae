const TURN = 0.08, MOVE = 0.06, ZOOM = 1.12;

/** Keys of the whole page; a control in focus keeps those that it needs. */
export function addKeys(page) {
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    if (target.closest?.(".table-scroll") && /^(Arrow|Home$|End$|Page| $)/.test(event.key)) return; // they scroll it
    const field = target.closest?.("input, select, textarea, summary, button, a");
    const typed = field && !(field.type === "checkbox" && event.key !== " ");
    if (typed && !(field.tagName === "BUTTON" && event.key !== " " && event.key !== "Enter")) return;
    const act = actions(page)[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}

function actions(page) {
  const { timeline, scene, toolbar } = page;
  const always = {
    " ": () => timeline.toggle(), ArrowLeft: () => timeline.move(-1), ArrowRight: () => timeline.move(1),
    Home: () => timeline.move(-timeline.step), End: () => timeline.move(timeline.steps),
  };
  if (!scene) return always;
  const look = (act) => () => {
    act();
    toolbar.noFollow();
  };
  return {
    ...always,
    ...Object.fromEntries(Array.from({ length: 10 }, (_, i) => [String((i + 1) % 10), () => toolbar.toggleLayer(i)])),
    h: look(() => scene.home()), t: look(() => scene.top()), f: () => toolbar.nextFollow(), p: () => page.savePicture(),
    w: () => scene.pan(0, MOVE), s: () => scene.pan(0, -MOVE), a: () => scene.pan(-MOVE, 0), d: () => scene.pan(MOVE, 0),
    q: () => scene.orbit(-TURN, 0), e: () => scene.orbit(TURN, 0), r: () => scene.orbit(0, -TURN), v: () => scene.orbit(0, TURN),
    "+": () => scene.zoom(1 / ZOOM), "=": () => scene.zoom(1 / ZOOM), "-": () => scene.zoom(ZOOM),
  };
}
