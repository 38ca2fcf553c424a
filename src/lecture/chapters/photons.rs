//! Photon mapping: one map, and many.

use super::contest::equal_time;
use super::prelude::*;
use super::scenes::{CORNELL, SPHERES};

pub const CHAPTER: Chapter =
    Chapter { name: "photons", titles: ("Photon mapping", "Mapa de fotones"), needs: &["photon", "path"], write };

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "What if light is first left on all surfaces, and then looked up?",
        "¿Y si primero se deja la luz en todas las superficies y luego se consulta?",
    ));
    sheet.equation(
        "L ( x , ω ) ≈ { 1 } over { π r ^ 2 } ∑ _ { | x _ i − x | < r } f ( x , ω _ i , ω ) Φ _ i , r _ { k + 1 } ^ 2 = r _ k ^ 2 { k + α } over { k + 1 }",
        text(
            "Jensen 1996: the photons within r stand for the light at x, which blurs it. Progressive photon mapping (Hachisuka et al. 2008; Knaus and Zwicker 2011) \
             makes a map for every sample, each with a smaller radius: noise and blur vanish together.",
            "Jensen 1996: los fotones a menos de r representan la luz en x, lo que la desenfoca. El mapa de fotones progresivo (Hachisuka et al. 2008; Knaus y \
             Zwicker 2011) hace un mapa por muestra, cada uno con un radio menor: el ruido y el desenfoque desaparecen juntos.",
        ),
    );
    let reference = CORNELL.reference(lab)?;
    let variants = [
        ("one-wide", "photon:direct=photons:radius=0.1", 1, text("One map, wide radius", "Un mapa, radio grande")),
        ("one", "photon:direct=photons", 1, text("One map, all light from photons", "Un mapa, toda la luz de fotones")),
        (
            "many",
            "photon:direct=photons",
            256,
            text("Many maps, all light from photons", "Muchos mapas, toda la luz de fotones"),
        ),
        (
            "one-nee",
            "photon",
            1,
            text("One map, direct light by shadow rays", "Un mapa, luz directa con rayos de sombra"),
        ),
        (
            "many-nee",
            "photon",
            256,
            text("Many maps, direct light by shadow rays", "Muchos mapas, luz directa con rayos de sombra"),
        ),
    ];
    let mut cells = Vec::new();
    for (name, technique, spp, title) in variants {
        let run = lab.render(&format!("photons-{name}"), CORNELL.shot(technique).samples(spp))?;
        let found = lab.compare(&run, &reference)?;
        cells.push(picture(&run, CORNELL.exposure, title.clone(), CORNELL.alt(&title), error_caption(&run, &found)));
    }
    let path = equal_time(lab, &CORNELL, "path")?;
    let title = text("Explicit path tracing", "Trazado de caminos explícito");
    cells.push(picture(
        &path.run,
        CORNELL.exposure,
        title.clone(),
        CORNELL.alt(&title),
        error_caption(&path.run, &path.found),
    ));
    sheet.gallery(3, cells, exposure_note(CORNELL.exposure))?;
    sheet.see(text(
        "A wide radius gives a smooth picture that is wrong at every edge: light leaks under the blocks, and corners go dark. A narrow one gives spots. The \
         mean of many maps of shrinking radius has neither. In this room, where a lamp is easily aimed at, a path tracer needs no map.",
        "Un radio grande da una imagen suave y equivocada en cada borde: la luz se cuela bajo los bloques y los rincones se oscurecen. Uno pequeño da manchas. La \
         media de muchos mapas de radio decreciente no tiene ni lo uno ni lo otro. En esta habitación, donde es fácil apuntar a la lámpara, el \
         trazado de caminos no necesita mapa.",
    ));
    sheet.commands(&lab.take_commands());

    sheet.heading(SPHERES.title());
    let mut cells = Vec::new();
    let mut errors = Vec::new();
    for (technique, title) in [("path", title), ("photon", text("Photon mapping", "Mapa de fotones"))] {
        let entry = equal_time(lab, &SPHERES, technique)?;
        errors.push(entry.found.relmse());
        cells.push(picture(
            &entry.run,
            SPHERES.exposure,
            title.clone(),
            SPHERES.alt(&title),
            error_caption(&entry.run, &entry.found),
        ));
    }
    sheet.gallery(3, cells, exposure_note(SPHERES.exposure))?;
    let ratio = figure(errors[0] / errors[1]);
    sheet.see(text(
        format!("With glass in the room the caustic is found by every map. At equal time the squared error of path tracing is {ratio} times that of photon mapping."),
        format!("Con vidrio en la habitación, cada mapa encuentra la cáustica. A igual tiempo, el error al cuadrado del trazado de caminos es {ratio} veces el del mapa de fotones."),
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}
