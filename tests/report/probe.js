// Loads the page `text` into frames as wide as a desktop's window and as a phone (a window of its own cannot be narrower
// than 500 px), uses what there is to use, and posts what it found.
const probe = async (frame) => {
  const page = frame.contentDocument, root = page.documentElement, view = frame.contentWindow;
  const all = (selector) => [...page.querySelectorAll(selector)];
  const one = (selector) => page.querySelector(selector);
  const seen = (element) => element.getClientRects().length > 0;
  const press = (element, key) => element.dispatchEvent(new view.KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  const found = { window: root.clientWidth, content: root.scrollWidth };
  const charts = all(".panel .chart").filter(seen);
  found.charts = charts.map((chart) => chart.classList[1] + ":" + chart.closest(".panel").dataset.metric).join("+");
  found.letters = Math.round(10 * Math.min(...charts.map((chart) => 13 * chart.getBoundingClientRect().width / chart.viewBox.baseVal.width)));
  one("input[name=metric-0][value=mape]").click();
  found.panel = all(".scene:first-of-type .panel, #scene-0 ~ .curves .panel").filter(seen).map((panel) => panel.dataset.metric).join("+");
  one(".legend button").click();
  found.off = all(".series.off").length > 0;
  const stage = one(".stage"), range = one(".divider input");
  const images = [...stage.querySelectorAll("img")];
  await Promise.all(images.map((image) => image.decode()));
  found.size = images[0].naturalWidth + "x" + images[0].naturalHeight;
  press(stage, "ArrowRight");
  found.range = range.value;
  found.clip = images[1].style.clipPath.replaceAll(" ", "_");
  // No pointer of these events exists, so none can be captured.
  Object.assign(stage, { setPointerCapture() {}, hasPointerCapture: () => true });
  const place = stage.getBoundingClientRect();
  const point = (name, share) => {
    const clientX = place.left + share * place.width;
    stage.dispatchEvent(new view.PointerEvent(name, { clientX, clientY: place.top + 1, bubbles: true }));
    return range.value;
  };
  found.dragged = point("pointerdown", 0.25) + "+" + point("pointermove", 0.8) + "+" + point("pointermove", 1.2);
  const shown = [];
  one("input[name=mode-0][value=flip]").click();
  shown.push(stage.dataset.shown);
  press(stage, " ");
  shown.push(stage.dataset.shown);
  stage.click();
  shown.push(stage.dataset.shown);
  found.flips = shown.join("+");
  const before = images[0].src, right = one("select.right");
  right.selectedIndex = right.options.length - 1;
  right.dispatchEvent(new view.Event("change"));
  found.chosen = images[0].src !== before && images[0].src === one("#" + right.value).getAttribute("href");
  const blobs = [];
  view.URL.createObjectURL = (blob) => { blobs.push(blob); return "blob:none"; };
  view.HTMLAnchorElement.prototype.click = function () { found.names = (found.names || "") + this.download; };
  all("[data-download]").forEach((button) => button.click());
  found.json = JSON.parse(await blobs[0].text()).schema;
  found.csv = (await blobs[1].text()).split(",")[0];
  found.ready = root.dataset.ready;
  found.error = root.dataset.error || "none";
  return Object.entries(found).map(([name, value]) => name + "=" + value).join(" ");
};
const run = (width) => new Promise((done) => {
  const frame = Object.assign(document.createElement("iframe"), { width, height: 844, srcdoc: text });
  frame.addEventListener("load", () => probe(frame).catch((error) => "failed: " + error.message.replaceAll('"', "'")).then(done));
  document.body.append(frame);
});
run(1280).then(async (wide) => fetch("/found", { method: "POST", body: wide + "|" + await run(390) }));
