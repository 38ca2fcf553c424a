//! Implicit against explicit paths.

use super::contest::{EQUAL_TIME, equal_time};
use super::prelude::*;
use super::scenes::{CORNELL, Room, SPHERES};

pub const CHAPTER: Chapter = Chapter {
    name: "explicit",
    titles: ("Implicit against explicit paths", "Caminos implícitos frente a explícitos"),
    needs: &["path", "path-implicit"],
    write,
};

const TECHNIQUES: [(&str, &str, &str); 2] =
    [("path-implicit", "Implicit", "Implícito"), ("path", "Explicit", "Explícito")];
const SAMPLES: [u32; 2] = [32, 512];

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "Wait until a path runs into a lamp, or aim at one from every vertex?",
        "¿Esperar a que un camino dé con una lámpara, o apuntar a una desde cada vértice?",
    ));
    sheet.equation(
        "L ≈ w _ 1 { f L _ e cos θ } over { p _ 1 } + w _ 2 { f L _ e cos θ V } over { p _ 2 } , w _ i = { p _ i ^ 2 } over { p _ 1 ^ 2 + p _ 2 ^ 2 }",
        text(
            "Two ways to sample the same light: 1, a direction that the surface chooses; 2, a point of a lamp, seen or not (V; next-event estimation). \
             Explicit paths use both and weigh them by multiple importance sampling (Veach 1997, chapter 9).",
            "Dos maneras de muestrear la misma luz: 1, una dirección que elige la superficie; 2, un punto de una lámpara, visible o no (V; \
             estimación del siguiente evento). Los caminos explícitos usan ambas y las ponderan con muestreo por importancia múltiple (Veach 1997, capítulo 9).",
        ),
    );
    rows(lab, sheet, &CORNELL, &SAMPLES)?;
    sheet.heading(SPHERES.title());
    rows(lab, sheet, &SPHERES, &[])
}

fn rows(lab: &mut Lab, sheet: &mut Sheet, room: &Room, spps: &[u32]) -> Result<()> {
    let reference = room.reference(lab)?;
    let mut errors = Vec::new();
    let mut cells = Vec::new();
    for (technique, en, es) in TECHNIQUES {
        for spp in spps {
            let run = lab.render(&format!("explicit-{technique}-{spp}"), room.shot(technique).samples(*spp))?;
            let found = lab.compare(&run, &reference)?;
            let title = text(format!("{en}, {} spp", samples(run.spp())), format!("{es}, {} spp", samples(run.spp())));
            cells.push(picture(&run, room.exposure, title.clone(), room.alt(&title), error_caption(&run, &found)));
        }
        let entry = equal_time(lab, room, technique)?;
        errors.push((entry.found.relmse(), entry.run.spp()));
        let title = text(format!("{en}, {EQUAL_TIME} s"), format!("{es}, {EQUAL_TIME} s"));
        cells.push(picture(
            &entry.run,
            room.exposure,
            title.clone(),
            room.alt(&title),
            error_caption(&entry.run, &entry.found),
        ));
    }
    sheet.gallery(3, cells, exposure_note(room.exposure))?;
    let [implicit, explicit] = [errors[0], errors[1]];
    let (gain, cost) = (figure(implicit.0 / explicit.0), figure(implicit.1 / explicit.1));
    let both = if spps.is_empty() {
        text(
            format!(
                "At equal time explicit paths have {gain} times less squared error here. The lead is smaller than in the room above: \
                 the caustic below the glass is found by chance alone in both, for no aim at a lamp goes through glass; it is the speckle that is left."
            ),
            format!(
                "A igual tiempo, los caminos explícitos tienen aquí un error al cuadrado {gain} veces menor. La ventaja es menor que en la \
                 habitación anterior: en ambos casos la cáustica bajo el vidrio se encuentra solo por azar, pues no se puede apuntar a una lámpara \
                 a través del vidrio; es el moteado que queda."
            ),
        )
    } else {
        text(
            format!(
                "Implicit paths show the room through black grain: most of them never meet the lamp, and those that do are bright. An implicit \
                 sample is cheaper, {cost} of them in the time of an explicit one, and still at equal time explicit paths have \
                 {gain} times less squared error."
            ),
            format!(
                "Los caminos implícitos muestran la habitación tras un grano negro: la mayoría nunca da con la lámpara, y los que dan son muy \
                 brillantes. Una muestra implícita es más barata, {cost} en el tiempo de una explícita, y aun así, a igual tiempo, los \
                 caminos explícitos tienen un error al cuadrado {gain} veces menor."
            ),
        )
    };
    sheet.see(both);
    sheet.commands(&lab.take_commands());
    Ok(())
}
