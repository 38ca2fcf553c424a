//! Metropolis light transport against bidirectional path tracing at equal time.

use super::prelude::*;
use super::scenes::{DOOR, RING, Room};
use crate::render::Technique;

pub const CHAPTER: Chapter = Chapter {
    name: "metropolis",
    titles: ("Metropolis light transport", "Transporte de luz de Metropolis"),
    needs: &["mlt", "bdpt"],
    write,
};

/// Mutations per pixel.
const MUTATIONS: u32 = 250;

/// The technique's forms with what they mutate; those that the table does not have are left out.
const FORMS: [(&str, &str, &str); 3] = [
    ("primary", "Primary sample space", "Espacio primario de muestras"),
    ("multiplexed", "Multiplexed", "Multiplexado"),
    ("paths", "Path space", "Espacio de caminos"),
];

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        format!("A path that found light is rare. What do {MUTATIONS} small changes of it per pixel buy?"),
        format!("Un camino que encuentra luz es raro. ¿Qué se gana con {MUTATIONS} pequeños cambios suyos por píxel?"),
    ));
    sheet.equation(
        "a ( X → Y ) = min ( 1 , { f ( Y ) T ( Y → X ) } over { f ( X ) T ( X → Y ) } )",
        text(
            "Veach and Guibas 1997; in primary sample space Kelemen et al. 2002, multiplexed Hachisuka et al. 2014. A proposal Y that contributes more light than X \
             is always taken, another one with the probability a: paths are visited in proportion to the light f that they carry.",
            "Veach y Guibas 1997; en el espacio primario de muestras, Kelemen et al. 2002; multiplexado, Hachisuka et al. 2014. Una propuesta Y que aporta más luz que X \
             se acepta siempre; otra, con probabilidad a: los caminos se visitan en proporción a la luz f que llevan.",
        ),
    );
    for room in [&DOOR, &RING] {
        show(lab, sheet, room)?;
    }
    sheet.see(text(
        "Metropolis has few white specks: a rare bright path is explored instead of counted once with a large weight, unless it is so much brighter than others that \
         it would hold its chain for longer than the picture takes. It pays with errors that are correlated: \
         blotches where a chain stayed, and regions that it has visited too seldom. In the primary space the sun is met by chance alone, \
         as by a path tracer: a chain that did stays, and leaves a bright spot of the caustic instead of all of it. Bidirectional path tracing has its noise from pixel to pixel.",
        "Metropolis deja pocas motas blancas: un camino raro y brillante se explora en lugar de contarse una vez con un peso enorme, salvo si brilla tanto más que \
         otros que retendría a su cadena más tiempo del que dura la imagen. A cambio, sus errores van \
         juntos: manchas donde una cadena se quedó y zonas que ha visitado demasiado poco. En el espacio primario, solo el azar da con el \
         sol, como en un trazador de caminos: la cadena que lo consigue se queda, y deja una mancha brillante de la cáustica en lugar de toda ella. El ruido del trazado bidireccional es de píxel a píxel.",
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}

/// A room by all forms, beside `bdpt` with the seconds that the slowest of them took.
fn show(lab: &mut Lab, sheet: &mut Sheet, room: &Room) -> Result<()> {
    sheet.heading(room.title());
    let reference = room.reference(lab)?;
    let mut cells = Vec::new();
    let mut longest: f64 = 0.0;
    for (form, en, es) in FORMS {
        if Technique::parse(&format!("mlt:form={form}")).is_err() {
            continue;
        }
        let shot = room.shot(format!("mlt:form={form}")).samples(MUTATIONS);
        let run = lab.render(&format!("metropolis-{}-{form}", room.name), shot)?;
        longest = longest.max(run.seconds());
        let found = lab.compare(&run, &reference)?;
        let mutations = text(
            format!("{} mutations per pixel", samples(run.spp())),
            format!("{} mutaciones por píxel", samples(run.spp())),
        );
        let caption = vec![relmse(&found), mutations, seconds(&run)];
        let title = text(en, es);
        cells.push(picture(&run, room.exposure, title.clone(), room.alt(&title), caption));
    }
    let run =
        lab.render(&format!("metropolis-{}-bdpt", room.name), room.shot("bdpt").seconds(longest).that_was_measured())?;
    let found = lab.compare(&run, &reference)?;
    let title = text("Bidirectional path tracing", "Trazado de caminos bidireccional");
    cells.push(picture(&run, room.exposure, title.clone(), room.alt(&title), error_caption(&run, &found)));
    let note = text(
        format!("Bidirectional path tracing gets the seconds of the slowest form. Exposure ×{}.", room.exposure),
        format!(
            "El trazado bidireccional dispone de los segundos de la forma más lenta. Exposición ×{}.",
            room.exposure
        ),
    );
    sheet.gallery(4, cells, note)
}
