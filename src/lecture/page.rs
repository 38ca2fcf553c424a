//! The page: its head, its contents, the chapters one after the other.

use super::chapter::{Chapter, Circumstances};
use super::sheet::Sheet;
use super::text::{Text, text};
use crate::report::html::escape;
use crate::report::number::whole;

const STYLE: &str = include_str!("../report/style.css");
const OWN_STYLE: &str = include_str!("lecture.css");
const SCRIPT: &str = include_str!("lecture.js");

/// The whole page.
pub fn page(chapters: &[&Chapter], sheet: Sheet, circumstances: &Circumstances, took: f64) -> String {
    let (html, pictures) = sheet.into_parts();
    let title = text("Global illumination, measured", "La iluminación global, medida");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\" data-title-en=\"{en}\" data-title-es=\"{es}\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"generator\" content=\"lumbre {version}\"/>\n<title>{en} · {es}</title>\n\
         <style>\n{STYLE}{OWN_STYLE}</style>\n</head>\n<body>\n{store}{switch}<header>\n{heading}\n{head}</header>\n{contents}\
         <main>\n{html}</main>\n{footer}<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        en = escape(&title.en),
        es = escape(&title.es),
        version = escape(&circumstances.version),
        store = pictures.store(),
        switch = SWITCH,
        heading = title.within("h1"),
        head = head(circumstances, took),
        contents = contents(chapters),
        footer = footer(circumstances),
    )
}

/// The choice of language; it works without the script, which only makes the first choice.
const SWITCH: &str = "<fieldset class=\"switch languages\"><legend><span lang=\"en\">Language</span><span lang=\"es\">Idioma</span></legend>\
    <label><input type=\"radio\" name=\"language\" id=\"language-en\" value=\"en\" checked=\"checked\"/> <span class=\"name\">English</span></label>\
    <label><input type=\"radio\" name=\"language\" id=\"language-es\" value=\"es\"/> <span class=\"name\">Español</span></label></fieldset>\n";

fn head(circumstances: &Circumstances, took: f64) -> String {
    let lead = text(
        "The comparisons of a lecture on global illumination, each made on this machine by the commands that stand below it. No \
         figure here was typed in: all are read from what those commands wrote. Pictures are linear radiance times the stated exposure, \
         clamped, with the sRGB curve; those of one comparison share the exposure.",
        "Las comparaciones de una clase sobre iluminación global, hechas en esta máquina con las órdenes que figuran debajo de cada una. \
         Ninguna cifra se ha escrito a mano: todas se leen de lo que dejaron esas órdenes. Las imágenes son radiancia lineal multiplicada por \
         la exposición indicada, recortada y con la curva sRGB; las de una misma comparación comparten la exposición.",
    );
    let device = &circumstances.device;
    let fact = |term: Text, value: String| format!("<div><dt>{}</dt><dd>{value}</dd></div>\n", term.inline());
    let facts = [
        fact(text("Device", "Dispositivo"), escape(&device.name)),
        fact(text("Driver", "Controlador"), escape(&device.driver)),
        fact(
            text("Host", "Equipo"),
            format!(
                "{}, {}",
                escape(&device.host),
                text(
                    format!("{} logical processors", device.processors),
                    format!("{} procesadores lógicos", device.processors)
                )
                .inline()
            ),
        ),
        fact(text("Made", "Fecha"), escape(&circumstances.made)),
        fact(text("All commands together", "Todas las órdenes"), format!("{} s", whole(took.round() as u64))),
    ];
    let terms = text(
        "<strong>relMSE</strong> is the mean of (a − b)² / (b² + 0.01) over pixels and channels, a the picture and b the reference, a longer \
         rendering with other random numbers. <strong>spp</strong> are samples per pixel. <strong>s</strong> are seconds of rendering, \
         without reading the scene and making kernels. <strong>±</strong> is one standard error. Equal time means that both commands had the same \
         <code>-t</code>. Single renderings of rare light scatter: relMSE of such pictures is one draw of many; \
         <code>lumbre bench</code> gives intervals.",
        "<strong>relMSE</strong> es la media de (a − b)² / (b² + 0.01) sobre píxeles y canales, donde a es la imagen y b la referencia, un cálculo \
         más largo con otros números aleatorios. <strong>spp</strong> son muestras por píxel. <strong>s</strong> son segundos de cálculo de la imagen, \
         sin contar la lectura de la escena ni la compilación. <strong>±</strong> es un error estándar. «A igual tiempo» significa que ambas órdenes \
         llevaban el mismo <code>-t</code>. Donde la luz se encuentra rara vez, un solo cálculo es un sorteo entre muchos y su relMSE \
         varía; <code>lumbre bench</code> da intervalos.",
    );
    format!(
        "{}\n<dl class=\"facts\">\n{}</dl>\n{}\n",
        lead.within("p class=\"lead\""),
        facts.concat(),
        terms.within("p class=\"prose quiet\"")
    )
}

fn contents(chapters: &[&Chapter]) -> String {
    let title = text("Contents", "Índice");
    let entries: String = chapters
        .iter()
        .map(|chapter| format!("<li><a href=\"#{}\">{}</a></li>\n", chapter.name, chapter.title().inline()))
        .collect();
    format!(
        "<nav aria-labelledby=\"contents\">\n<h2 id=\"contents\">{}</h2>\n<ol>\n{entries}</ol>\n</nav>\n",
        title.inline()
    )
}

/// What opens a chapter.
pub fn open_chapter(number: usize, chapter: &Chapter) -> String {
    let name = chapter.name;
    format!(
        "<section class=\"chapter\" id=\"{name}\" aria-labelledby=\"{name}-title\">\n<h2 id=\"{name}-title\">{number}. {}</h2>\n",
        chapter.title().inline()
    )
}

fn footer(circumstances: &Circumstances) -> String {
    let made = text(
        format!("Made by <code>{}</code>, lumbre {}.", escape(&circumstances.command), escape(&circumstances.version)),
        format!(
            "Hecha con <code>{}</code>, lumbre {}.",
            escape(&circumstances.command),
            escape(&circumstances.version)
        ),
    );
    format!("<footer>\n{}\n</footer>\n", made.within("p class=\"quiet\""))
}
