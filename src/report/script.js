"use strict";
(() => {
  const page = document.documentElement;
  window.addEventListener("error", (event) => { page.dataset.error = event.message; });

  const make = (name, properties, ...children) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...children);
    return element;
  };

  // One measure of error at a time.
  const measures = (scene) => {
    const panels = scene.querySelectorAll(".panel");
    const show = (metric) => panels.forEach((panel) => { panel.hidden = panel.dataset.metric !== metric; });
    scene.querySelectorAll("input[name^='metric-']").forEach((input) => {
      input.addEventListener("change", () => show(input.value));
      // A browser that reloads the page may have kept another choice.
      if (input.checked) show(input.value);
    });
  };

  // Names in the legend take their curves away and bring them back.
  const legend = (scene) => {
    scene.querySelectorAll(".legend li").forEach((item) => {
      const button = make("button", { type: "button", title: "Show or hide this variant" }, ...item.childNodes);
      button.setAttribute("aria-pressed", "true");
      button.addEventListener("click", () => {
        const shown = button.getAttribute("aria-pressed") !== "true";
        button.setAttribute("aria-pressed", String(shown));
        scene.querySelectorAll(`.chart .series[data-series="${item.dataset.series}"]`)
          .forEach((series) => series.classList.toggle("off", !shown));
      });
      item.append(button);
    });
  };

  // Two images over each other: a divider between them, or one at a time.
  const comparison = (box) => {
    const stage = box.querySelector(".stage");
    const left = box.querySelector("select.left");
    const right = box.querySelector("select.right");
    const range = box.querySelector("input[type=range]");
    const modes = [...box.querySelectorAll("input[name^='mode-']")];
    const hint = box.querySelector(".hint");
    const under = make("img", { alt: "", draggable: false });
    const over = make("img", { alt: "", draggable: false });
    const line = make("span", { className: "line" }, make("span", { className: "grip", textContent: "\u2194" }));
    const tags = [make("span", { className: "tag left" }), make("span", { className: "tag right" })];
    stage.append(under, over, line, ...tags);
    let second = false;

    const flips = () => modes.some((mode) => mode.checked && mode.value === "flip");
    const name = (select) => select.selectedOptions[0].textContent;
    const draw = () => {
      const at = Number(range.value);
      const flip = flips();
      stage.classList.toggle("flips", flip);
      stage.dataset.shown = flip ? (second ? "right" : "left") : "both";
      over.style.clipPath = flip ? "none" : `inset(0 ${100 - at}% 0 0)`;
      over.style.visibility = flip && second ? "hidden" : "visible";
      line.hidden = flip;
      line.style.left = `${at}%`;
      tags[0].hidden = flip && second;
      tags[1].hidden = flip && !second;
      range.parentElement.hidden = flip;
      hint.textContent = flip
        ? `Shown: ${name(second ? right : left)}. Click the image, or press space on it, for the other one.`
        : "Drag the divider, or focus the image and use the arrow keys.";
    };
    const load = () => {
      for (const [select, image, tag] of [[left, over, tags[0]], [right, under, tags[1]]]) {
        image.src = document.getElementById(select.value).getAttribute("href");
        image.alt = name(select);
        tag.textContent = name(select);
        image.decode().then(() => {
          image.classList.toggle("pixelated", image.naturalWidth < stage.clientWidth);
        }, () => {});
      }
      draw();
    };
    const move = (to) => { range.value = String(Math.min(100, Math.max(0, to))); draw(); };
    const toggle = () => { second = !second; draw(); };
    const follow = (event) => {
      const place = stage.getBoundingClientRect();
      move(100 * (event.clientX - place.left) / place.width);
    };

    stage.addEventListener("pointerdown", (event) => {
      if (flips() || event.button !== 0) return;
      stage.setPointerCapture(event.pointerId);
      follow(event);
    });
    stage.addEventListener("pointermove", (event) => {
      if (!flips() && stage.hasPointerCapture(event.pointerId)) follow(event);
    });
    stage.addEventListener("click", () => { if (flips()) toggle(); });
    stage.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: -2, ArrowRight: 2, PageDown: -10, PageUp: 10, Home: -100, End: 100 };
      if (flips() && (event.key === " " || event.key === "Enter")) toggle();
      else if (!flips() && event.key in steps) move(Number(range.value) + steps[event.key]);
      else return;
      event.preventDefault();
    });
    range.addEventListener("input", draw);
    [left, right].forEach((select) => select.addEventListener("change", load));
    modes.forEach((mode) => mode.addEventListener("change", draw));
    load();
  };

  // The figures as files: the table is kept as a JSON string.
  const downloads = () => {
    document.querySelectorAll("[data-download]").forEach((button) => {
      button.addEventListener("click", () => {
        const text = document.getElementById(button.dataset.download).textContent;
        const value = JSON.parse(text);
        const isTable = typeof value === "string";
        const content = isTable ? value : JSON.stringify(value, null, 2);
        const url = URL.createObjectURL(new Blob([content], { type: isTable ? "text/csv" : "application/json" }));
        const link = make("a", { href: url, download: button.dataset.name });
        link.click();
        setTimeout(() => URL.revokeObjectURL(url), 10000);
      });
    });
  };

  document.querySelectorAll("section.scene").forEach((scene) => {
    measures(scene);
    legend(scene);
    scene.querySelectorAll(".compare").forEach(comparison);
  });
  downloads();
  page.classList.add("scripted");
  page.dataset.ready = "yes";
})();
