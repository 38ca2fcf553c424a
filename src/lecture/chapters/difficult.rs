//! Light that is hard to find, by every technique at equal time.

use super::contest::{self, EQUAL_TIME};
use super::prelude::*;
use super::scenes::{DOOR, REFLECTED, RING, Room, SMALL_LIGHT};

pub const CHAPTER: Chapter = Chapter {
    name: "difficult",
    titles: ("Difficult light", "Luz difícil"),
    needs: &["path", "light", "bdpt", "vcm", "photon"],
    write,
};

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        format!("Who finds the light that few paths carry? Every technique gets {EQUAL_TIME} seconds."),
        format!("¿Quién encuentra la luz que pocos caminos llevan? Cada técnica dispone de {EQUAL_TIME} segundos."),
    ));
    sheet.equation(
        "E { ( S | D ) } ^ ∗ L",
        text(
            "Heckbert 1990: a path from the eye E over specular (S) and diffuse (D) surfaces to the light L. A caustic is E D S L; seen in a mirror, \
             E S D S L. Next-event estimation needs a D just before L; a light subpath that is connected to the camera needs a D just after E.",
            "Heckbert 1990: un camino del ojo E a la luz L por superficies especulares (S) y difusas (D). Una cáustica es E D S L; vista en un espejo, \
             E S D S L. La estimación del siguiente evento necesita una D justo antes de L; un camino de luz que se muestra a la cámara, una D justo \
             después de E.",
        ),
    );
    let rooms: [(&Room, Text); 4] = [
        (
            &SMALL_LIGHT,
            text(
                "E D S L with a tiny light. A path that leaves the floor towards the glass hardly ever ends on the lamp: `path` shows single bright \
                 pixels, and a dark shadow in between. Paths from the lamp draw the caustic at once. `light` leaves the glass itself black: \
                 no vertex behind it can be connected to the camera.",
                "E D S L con una luz diminuta. Un camino que sale del suelo hacia el vidrio casi nunca acaba en la lámpara: `path` muestra píxeles \
                 brillantes aislados y, entre ellos, una sombra oscura. Los caminos que parten de la lámpara dibujan la cáustica enseguida. `light` deja \
                 negro el propio vidrio: lo que la cámara ve a través de él no se le puede mostrar.",
            ),
        ),
        (
            &RING,
            text(
                "Complex geometry: the curve that the inner wall of the ring gathers, and its image in the metal, which is E S D S L. Connections \
                 alone (`bdpt`) find only the former; merging at nearby points (`photon`, `vcm`) finds both.",
                "Geometría compleja: la curva que junta la pared interior del anillo, y su imagen en el metal, que es E S D S L. Las conexiones por sí \
                 solas (`bdpt`) únicamente encuentran la primera; la fusión con puntos cercanos (`photon`, `vcm`) encuentra ambas.",
            ),
        ),
        (
            &REFLECTED,
            text(
                "E S D S L in full view: the bright side of the card is seen in the mirror alone. `light` shows a black mirror. `path` and \
                 `bdpt` must run into the lamp by chance; in `photon` and `vcm` the caustic is on the card before the camera asks for it.",
                "E S D S L a la vista: la cara iluminada de la tarjeta solo se ve en el espejo. `light` muestra un espejo negro. `path` y `bdpt` \
                 tienen que dar con la lámpara por azar; en `photon` y `vcm` la cáustica ya está en la tarjeta cuando la cámara pregunta por ella.",
            ),
        ),
        (
            &DOOR,
            text(
                "No caustic, but a narrow gap. Shadow rays nearly all end at the wall; paths from the lamp seldom find the way out. No technique \
                 is far ahead of `path`: the paths that do get through would have to be used again. A few pixels of the glass carafe, \
                 whose light next-event estimation cannot sample, decide the relMSE.",
                "No hay cáustica, sino una rendija. Casi todos los rayos de sombra acaban en la pared; los caminos de la lámpara rara vez encuentran \
                 la salida. Ninguna técnica aventaja mucho a `path`: habría que reutilizar los caminos que sí pasan. Unos pocos píxeles de la \
                 garrafa de vidrio, que solo el azar ilumina, deciden el relMSE.",
            ),
        ),
    ];
    for (room, what) in rooms {
        show(lab, sheet, room, &what)?;
    }
    Ok(())
}

fn show(lab: &mut Lab, sheet: &mut Sheet, room: &Room, what: &Text) -> Result<()> {
    sheet.heading(room.title());
    let reference = room.reference(lab)?;
    let title = text("Reference", "Referencia");
    let own = text(
        format!("own relMSE {}", figure(reference.own_relmse())),
        format!("relMSE propio {}", figure(reference.own_relmse())),
    );
    let caption = vec![own, spp(&reference), seconds(&reference)];
    let mut cells = vec![picture(&reference, room.exposure, title.clone(), room.alt(&title), caption)];
    for entry in contest::all(lab, room)? {
        let mut caption = error_caption(&entry.run, &entry.found);
        let typical = figure(entry.typical);
        caption.insert(1, text(format!("({typical} without the worst 1 %)"), format!("({typical} sin el peor 1 %)")));
        let energy = figure(entry.found.energy_ratio());
        caption.push(text(format!("energy {energy}"), format!("energía {energy}")));
        let title = same(format!("<code>{}</code>", entry.technique));
        cells.push(picture(&entry.run, room.exposure, title, room.alt_by(entry.technique), caption));
    }
    sheet.gallery(
        3,
        cells,
        text(
            format!("Exposure ×{}. Energy is the mean over that of the reference. In brackets the relMSE of all pixels but the worst hundredth.", room.exposure),
            format!("Exposición ×{}. La energía es la media entre la de la referencia. Entre paréntesis, el relMSE de todos los píxeles salvo el peor centésimo.", room.exposure),
        ),
    )?;
    sheet.see(what.map(code));
    sheet.commands(&lab.take_commands());
    Ok(())
}
