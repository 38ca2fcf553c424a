"use strict";
(() => {
  const page = document.documentElement;
  window.addEventListener("error", (event) => { page.dataset.error = event.message; });
  const inputs = [...document.querySelectorAll("input[name=language]")];

  const show = () => {
    const chosen = inputs.find((input) => input.checked).value;
    page.lang = chosen;
    document.title = chosen === "es" ? page.dataset.titleEs : page.dataset.titleEn;
  };
  const choose = (language) => {
    const input = inputs.find(({ value }) => value === language);
    if (input) input.checked = true;
    show();
    return Boolean(input);
  };
  // #es and #en choose a language; otherwise the first one that the browser prefers and the page has.
  const fromAddress = () => choose(location.hash.slice(1));
  if (!fromAddress()) {
    const wanted = navigator.languages.map((language) => language.slice(0, 2));
    choose(wanted.find((language) => inputs.some(({ value }) => value === language)));
  }
  window.addEventListener("hashchange", fromAddress);
  inputs.forEach((input) => input.addEventListener("change", show));
  // What is printed holds the commands.
  window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((box) => { box.open = true; }));
  page.dataset.ready = "yes";
})();
