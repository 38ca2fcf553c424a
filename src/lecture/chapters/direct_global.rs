//! Direct light against global illumination.

use super::prelude::*;
use super::scenes::{CORNELL, DOOR, Room};
use crate::lecture::run::{average, part_of};
use crate::lecture::sheet::figure_of_percent;
use crate::lecture::view;

pub const CHAPTER: Chapter = Chapter {
    name: "direct-global",
    titles: ("Direct against global", "Iluminación directa frente a global"),
    needs: &["direct", "path"],
    write,
};

/// A piece of the ceiling that the lamp, which lies in it, cannot see: left, top, right, bottom.
const CEILING: [f64; 4] = [0.2, 0.05, 0.4, 0.1];

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "How much of what we see came straight from a lamp, and how much from the walls?",
        "¿Cuánto de lo que vemos vino directamente de una lámpara, y cuánto de las paredes?",
    ));
    sheet.equation(
        "L = L _ e + T L _ e + T ^ 2 L _ e + T ^ 3 L _ e + …",
        text(
            "T scatters light once. Direct lighting ends after the second term: emission, and light that was scattered once. All that \
             follows is indirect.",
            "T dispersa la luz una vez. La iluminación directa acaba en el segundo término: la emisión y la luz dispersada una vez. Todo lo \
             que sigue es indirecta.",
        ),
    );
    let cornell = compare(lab, sheet, &CORNELL, 1024, true)?;
    sheet.see(text(
        format!(
            "Without indirect light the ceiling is black: measured on a piece of it, {} against {} of radiance. The \
             shadows have no light in them, and no wall lends its colour to a block. Of the light that surfaces scatter to the camera, {} is direct.",
            figure(cornell.ceiling[0]),
            figure(cornell.ceiling[1]),
            figure_of_percent(cornell.share)
        ),
        format!(
            "Sin luz indirecta el techo queda negro: medida en un trozo de él, la radiancia es {} frente a {}. En las sombras no \
             hay luz, y ninguna pared tiñe los bloques. De la luz que las superficies dispersan hacia la cámara, el {} es directa.",
            figure(cornell.ceiling[0]),
            figure(cornell.ceiling[1]),
            figure_of_percent(cornell.share)
        ),
    ));
    sheet.commands(&lab.take_commands());
    sheet.heading(DOOR.title());
    let door = compare(lab, sheet, &DOOR, 256, false)?;
    sheet.see(text(
        format!(
            "The only lamp is in the next room. What it lights directly is a strip beside the door, {} of all light in the picture; \
             everything else has bounced at least twice.",
            figure_of_percent(door.share)
        ),
        format!(
            "La única lámpara está en la habitación contigua. Lo que ilumina directamente es una franja junto a la puerta, el {} de toda la \
             luz de la imagen; el resto ha rebotado por lo menos dos veces.",
            figure_of_percent(door.share)
        ),
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}

struct Measured {
    /// Direct light of all light that surfaces scatter to the camera.
    share: f64,
    /// Radiance of [`CEILING`], direct and global.
    ceiling: [f64; 2],
}

fn compare(lab: &mut Lab, sheet: &mut Sheet, room: &Room, spp: u32, sees_lamp: bool) -> Result<Measured> {
    let direct = lab.render(&format!("direct-global-{}-direct", room.name), room.shot("direct").samples(spp))?;
    // Where the camera sees the lamp, the difference of two pictures is the noise of its edge: the layer is what lies beyond.
    let (global, indirect, lamp) = if sees_lamp {
        let shot = room.shot("path").samples(spp).with("--lengths=3");
        let global = lab.render(&format!("direct-global-{}-global", room.name), shot)?;
        let indirect = global.layer("length03plus")?;
        let lamp = average(&global.layer("length01")?);
        (global, indirect, lamp)
    } else {
        let global = room.reference(lab)?;
        let indirect = view::difference(&global.image, &direct.image);
        (global, indirect, 0.0)
    };
    // Of what surfaces scatter: the lamp itself, as the camera sees it, is left out.
    let scattered = average(&global.image) - lamp;
    let (share, rest) = ((average(&direct.image) - lamp) / scattered, average(&indirect) / scattered);
    let titles = [
        text("Direct", "Directa"),
        text("Global", "Global"),
        text("Global − direct: indirect", "Global − directa: indirecta"),
    ];
    let [of_direct, of_global, of_indirect] = titles;
    let part = |share: f64| {
        text(
            format!("<strong>{}</strong> of scattered light", figure_of_percent(share)),
            format!("<strong>{}</strong> de la luz dispersada", figure_of_percent(share)),
        )
    };
    let cells = vec![
        picture(
            &direct,
            room.exposure,
            of_direct.clone(),
            room.alt(&of_direct),
            vec![part(share), spp_and_time(&direct)],
        ),
        picture(
            &global,
            room.exposure,
            of_global.clone(),
            room.alt(&of_global),
            vec![part(1.0), spp_and_time(&global)],
        ),
        image(
            &format!("{}-indirect", room.name),
            &indirect,
            room.exposure,
            of_indirect.clone(),
            room.alt(&of_indirect),
            vec![part(rest)],
        ),
    ];
    sheet.gallery(3, cells, exposure_note(room.exposure))?;
    let ceiling = [&direct.image, &global.image].map(|image| average(&part_of(image, CEILING)));
    Ok(Measured { share, ceiling })
}

fn spp_and_time(run: &Run) -> Text {
    same(format!("{} spp, {} s", samples(run.spp()), figure(run.seconds())))
}
