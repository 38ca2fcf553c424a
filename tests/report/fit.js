// Loads each page of `texts` into frames as wide as a small desktop's window and as a small phone, opens all that can be opened, and posts
// the size of each window and what is wider than its place.
const fit = async (frame) => {
  const page = frame.contentDocument, root = page.documentElement;
  page.querySelectorAll("details").forEach((details) => { details.open = true; });
  const wide = [...page.querySelectorAll(".scroll, table, table tr, th, td, td > div, th > div")]
    .filter((element) => element.getClientRects().length > 0 && element.scrollWidth > element.clientWidth + 1 && element.clientWidth > 0)
    .map((element) => `${element.tagName}.${element.className}:${element.scrollWidth}>${element.clientWidth}`);
  // A table is as wide as what it holds, also where its place is narrower.
  page.querySelectorAll("table").forEach((table) => {
    const box = table.getBoundingClientRect();
    if (box.right > root.clientWidth || box.left < 0) wide.push(`${table.className} ends at ${Math.round(box.right)}`);
  });
  if (root.scrollWidth > root.clientWidth) wide.push(`page:${root.scrollWidth}`);
  const tables = page.querySelectorAll("table").length;
  return `${root.clientWidth} px, ${tables} tables: ${wide.length === 0 ? "fits" : wide.slice(0, 12).join(", ")}`;
};
const run = (text, width) => new Promise((done) => {
  const frame = Object.assign(document.createElement("iframe"), { width, height: 844, srcdoc: text });
  frame.addEventListener("load", () => fit(frame).catch((error) => "failed: " + error.message).then(done));
  document.body.append(frame);
});
(async () => {
  const found = [];
  for (const text of texts) for (const width of [1100, 360]) found.push(await run(text, width));
  await fetch("/found", { method: "POST", body: found.join("\n") });
})();
