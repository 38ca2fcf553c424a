//! Paths from the lamps alone.

use super::contest::{EQUAL_TIME, equal_time};
use super::prelude::*;
use super::scenes::{CORNELL, Room, SMALL_LIGHT, SPHERES};

pub const CHAPTER: Chapter =
    Chapter { name: "light-tracing", titles: ("Light tracing", "Trazado de luz"), needs: &["light", "path"], write };

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "Light runs from lamps to the eye. What if paths do as well?",
        "La luz va de las lámparas al ojo. ¿Y si los caminos también?",
    ));
    sheet.equation(
        "I _ j = ∫ W _ j ( y → x ) L ( y → x ) G d y = E [ Φ _ { path } W _ j f G / p ]",
        text(
            "The measurement equation (Veach 1997, equation 4.7), read from the lamp's end: each vertex of a path from a lamp is connected to the \
             camera, whose importance W says to which pixel j it belongs. One path adds to many pixels.",
            "La ecuación de medida (Veach 1997, ecuación 4.7), leída desde la lámpara: cada vértice de un camino que sale de una lámpara se muestra a \
             la cámara, cuya importancia W dice a qué píxel j pertenece. Un camino suma en muchos píxeles.",
        ),
    );
    let mut energies = Vec::new();
    for room in [&CORNELL, &SPHERES, &SMALL_LIGHT] {
        energies.push(row(lab, sheet, room)?);
    }
    let [diffuse, spheres] = [figure(energies[0]), figure(energies[1])];
    sheet.see(text(
        format!(
            "Grain follows another law: fine where much light falls and coarse in the dark, whatever the camera looks at. In the diffuse room \
             both techniques agree (energy {diffuse}). Mirrors and glass stay black, for no path from a lamp is ever reflected exactly into a \
             pinhole (energy {spheres}); the caustic that the glass throws is the best in the picture."
        ),
        format!(
            "El grano sigue otra ley: fino donde cae mucha luz y grueso en la oscuridad, mire donde mire la cámara. En la habitación difusa ambas \
             técnicas coinciden (energía {diffuse}). Los espejos y el vidrio quedan negros, pues ningún camino de una lámpara se refleja exactamente \
             hacia un orificio puntual (energía {spheres}); la cáustica que proyecta el vidrio es lo mejor de la imagen."
        ),
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}

/// A room by both techniques at equal time; the energy of light tracing.
fn row(lab: &mut Lab, sheet: &mut Sheet, room: &Room) -> Result<f64> {
    sheet.heading(room.title());
    let mut cells = Vec::new();
    let mut energy = f64::NAN;
    for (technique, title) in [
        ("path", text("Explicit path tracing", "Trazado de caminos explícito")),
        ("light", text("Light tracing", "Trazado de luz")),
    ] {
        let entry = equal_time(lab, room, technique)?;
        energy = entry.found.energy_ratio();
        let mut caption = error_caption(&entry.run, &entry.found);
        caption.push(text(format!("energy {}", figure(energy)), format!("energía {}", figure(energy))));
        cells.push(picture(&entry.run, room.exposure, title.clone(), room.alt(&title), caption));
    }
    sheet.gallery(
        3,
        cells,
        text(
            format!("{EQUAL_TIME} s each, exposure ×{}.", room.exposure),
            format!("{EQUAL_TIME} s cada una, exposición ×{}.", room.exposure),
        ),
    )?;
    Ok(energy)
}
