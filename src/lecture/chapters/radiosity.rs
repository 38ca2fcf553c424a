//! Radiosity, beside photon mapping and path tracing of the same room.

use super::prelude::*;
use super::scenes::CORNELL;
use crate::lecture::view;

pub const CHAPTER: Chapter = Chapter {
    name: "radiosity",
    titles: ("Photon mapping and radiosity of the same room", "Mapa de fotones y radiosidad de la misma habitación"),
    needs: &["radiosity", "photon"],
    write,
};

const BLOCK: u32 = 4;
const FULL: f64 = 0.2;

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "Where all is diffuse, light can be solved for the room instead of for the picture. What does that cost?",
        "Donde todo es difuso, la luz se puede resolver para la habitación en lugar de para la imagen. ¿A qué precio?",
    ));
    sheet.equation(
        "B _ i = E _ i + ρ _ i ∑ _ j F _ { i j } B _ j",
        text(
            "Goral et al. 1984: the surfaces are cut into patches of constant radiosity B; F is the share of what leaves patch i that arrives at patch j. A system of \
             linear equations, solved once, shows the room from everywhere.",
            "Goral et al. 1984: las superficies se cortan en parches de radiosidad B constante; F es la fracción de lo que sale del parche i que llega al parche j. Un \
             sistema de ecuaciones lineales, resuelto una vez, muestra la habitación desde cualquier sitio.",
        ),
    );
    let reference = CORNELL.reference(lab)?;
    let variants = [
        ("radiosity-patches", "radiosity:patches=32:shown=patches", text("Radiosity: patches", "Radiosidad: parches")),
        (
            "radiosity-vertices",
            "radiosity:patches=32:shown=vertices",
            text("Radiosity: interpolated", "Radiosidad: interpolada"),
        ),
        (
            "radiosity-gathered",
            "radiosity:patches=32:shown=gathered",
            text("Radiosity: gathered once more", "Radiosidad: con una recogida final"),
        ),
        ("photons-many-nee", "photon", text("Photon mapping", "Mapa de fotones")),
    ];
    let (mut cells, mut maps, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    for (name, technique, title) in variants {
        let run = lab.render(name, CORNELL.shot(technique).samples(256))?;
        let found = lab.compare(&run, &reference)?;
        cells.push(picture(&run, CORNELL.exposure, title.clone(), CORNELL.alt(&title), error_caption(&run, &found)));
        maps.push(Cell {
            name: format!("{name}-map"),
            image: view::bias_map(&run.image, &reference.image, BLOCK, FULL),
            title: title.clone(),
            alt: CORNELL
                .alt(&text(format!("map of its error: {}", title.en), format!("mapa de su error: {}", title.es))),
            caption: Vec::new(),
        });
        rows.push(vec![
            title,
            same(figure(found.relmse())),
            same(figure(found.energy_ratio())),
            same(figure(run.seconds())),
        ]);
    }
    sheet.gallery(4, cells, exposure_note(CORNELL.exposure))?;
    sheet.gallery(4, maps, same(""))?;
    sheet.map_legend(
        FULL,
        text(
            format!("Means of blocks of {BLOCK}×{BLOCK} pixels."),
            format!("Medias de bloques de {BLOCK}×{BLOCK} píxeles."),
        ),
    );
    let heads = [text("technique", "técnica"), same("relMSE"), text("energy", "energía"), text("seconds", "segundos")];
    sheet.table(&heads, &rows);
    sheet.see(text(
        "Radiosity has no noise; its errors are shapes: patches are seen, shadows follow the mesh rather than the blocks, and light leaks where a patch lies \
         half in the dark. Interpolation hides the patches and not the errors; gathering once more, from each pixel, brings the shadows back. \
         The bias of photon mapping is a blur that shrinks with every map, that of radiosity stays until the mesh is finer.",
        "La radiosidad no tiene ruido; sus errores son formas: se ven los parches, las sombras siguen la malla y no los bloques, y la luz se cuela donde un parche \
         está a medias en la sombra. Interpolar esconde los parches, no los errores; recoger la luz una vez más, desde cada píxel, devuelve las \
         sombras. El sesgo del mapa de fotones es un desenfoque que mengua con cada mapa; el de la radiosidad permanece hasta que la malla es más fina.",
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}
