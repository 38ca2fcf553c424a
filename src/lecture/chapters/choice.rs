//! Which technique for which light: the efficiencies of all rooms, and the table of techniques.

use super::contest::{self, EQUAL_TIME};
use super::prelude::*;
use super::scenes::{CORNELL, DOOR, LAMPS, REFLECTED, RING, Room, SMALL_LIGHT, SPHERES};
use crate::report::html::escape;
use crate::techniques::{Bias, TECHNIQUES, TechniqueRow};

pub const CHAPTER: Chapter = Chapter {
    name: "choice",
    titles: ("Which technique for which light", "Qué técnica para qué luz"),
    needs: &["path", "light", "bdpt", "vcm", "photon"],
    write,
};

const ROOMS: [&Room; 7] = [&CORNELL, &SPHERES, &LAMPS, &SMALL_LIGHT, &RING, &REFLECTED, &DOOR];

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "No technique is the best one everywhere. Which one is it for which light?",
        "Ninguna técnica es la mejor en todas partes. ¿Cuál lo es para qué luz?",
    ));
    sheet.equation(
        "ε = { 1 } over { relMSE × s }",
        text(
            format!(
                "Efficiency: twice as much reaches the same error in half the time. Below, that of each technique over that of path tracing, after {EQUAL_TIME} s \
                 each: above 1 it is better. The best of a room is bold. One rendering each: where path tracing finds the light by luck, its figure, \
                 and so the ratios, are luck too; docs/light_paths.md has intervals over five seeds or more."
            ),
            format!(
                "Eficiencia: con el doble se llega al mismo error en la mitad de tiempo. Abajo, la de cada técnica entre la del trazado de caminos, tras {EQUAL_TIME} s cada \
                 una: por encima de 1 es mejor. La mejor de cada habitación va en negrita. Es un solo cálculo de cada una: donde el trazado de caminos encuentra la luz \
                 por suerte, su cifra, y con ella los cocientes, también es suerte; docs/light_paths.md tiene intervalos sobre cinco semillas o más."
            ),
        ),
    );
    let mut rooms = Vec::new();
    for room in ROOMS {
        rooms.push((room.title(), contest::all(lab, room)?));
    }
    ratios(sheet, &rooms, |entry| entry.found.relmse());
    sheet.say(text(
        "The same by the relMSE of all pixels but the worst hundredth, which rare bright samples decide:",
        "Lo mismo según el relMSE de todos los píxeles salvo el peor centésimo, que deciden unas pocas muestras muy brillantes:",
    ));
    ratios(sheet, &rooms, |entry| entry.typical);
    sheet.see(text(
        "Read a row for the light, a column for the technique. Where the camera's paths can aim at the lamp, the cheapest sample wins. Where they cannot, but \
         paths from the lamp reach what the camera sees, these win. Where neither end can be joined to the other by a straight line, merging is what is left.",
        "Cada fila es una luz; cada columna, una técnica. Donde los caminos de la cámara pueden apuntar a la lámpara, gana la muestra más barata. Donde no pueden, pero los \
         caminos de la lámpara llegan a lo que ve la cámara, ganan estos. Donde ningún extremo se puede unir al otro con una recta, lo que queda es la fusión.",
    ));
    sheet.commands(&lab.take_commands());
    sheet.heading(text("The techniques", "Las técnicas"));
    let heads = [
        text("name", "nombre"),
        text("what it solves", "qué resuelve"),
        text("bias", "sesgo"),
        text("good at", "buena para"),
        text("bad at", "mala para"),
    ];
    let rows: Vec<Vec<Text>> = TECHNIQUES.iter().map(row).collect();
    sheet.raw("<div class=\"prose-table\">");
    sheet.table(&heads, &rows);
    sheet.raw("</div>\n");
    Ok(())
}

/// Efficiencies over those of path tracing, by some measure of error.
fn ratios(sheet: &mut Sheet, rooms: &[(Text, Vec<contest::Entry>)], error: impl Fn(&contest::Entry) -> f64) {
    let efficiency = |entry: &contest::Entry| 1.0 / (error(entry) * entry.run.seconds());
    let rows = rooms.iter().map(|(title, entries)| {
        let base = entries.iter().find(|entry| entry.technique == "path").map_or(f64::NAN, efficiency);
        let best = entries.iter().map(efficiency).fold(0.0, f64::max);
        let cells = entries.iter().map(|entry| {
            let ratio = figure(efficiency(entry) / base);
            same(if efficiency(entry) == best { format!("<strong>{ratio}</strong>") } else { ratio })
        });
        std::iter::once(title.clone()).chain(cells).collect()
    });
    let rows: Vec<Vec<Text>> = rows.collect();
    let mut heads = vec![text("room", "habitación")];
    heads.extend(contest::techniques().map(|name| same(format!("<code>{name}</code>"))));
    sheet.table(&heads, &rows);
}

fn row(row: &TechniqueRow) -> Vec<Text> {
    let bias = match row.bias {
        Bias::Unbiased => String::from("unbiased"),
        Bias::Biased(why) => format!("biased: {why}"),
        Bias::Consistent(why) => format!("consistent: {why}"),
    };
    let english = [row.solves.what(), &bias, row.good_at, row.bad_at].map(escape);
    let spanish = row.spanish.map(escape);
    let name = same(format!("<code>{}</code>", row.name));
    std::iter::once(name).chain(english.into_iter().zip(spanish).map(|(en, es)| text(en, es))).collect()
}
