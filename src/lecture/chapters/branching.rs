//! A tree of rays against one path, at equal numbers of rays.

use std::rc::Rc;

use super::prelude::*;
use super::scenes::SPHERES;
use crate::image::metrics::compare;
use crate::lecture::run::part_of;

pub const CHAPTER: Chapter = Chapter {
    name: "branching",
    titles: ("Branching rays against one path", "Rayos que se ramifican frente a un solo camino"),
    needs: &["whitted", "path"],
    write,
};

/// Samples of a rendering that only tells how many rays one takes.
const PILOT: u32 = 16;
/// The glass sphere within the picture: left, top, right, bottom.
const GLASS: [f64; 4] = [0.53, 0.68, 0.77, 0.92];

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "Where glass reflects and refracts: follow both rays, or one of them by chance?",
        "Donde el vidrio refleja y refracta: ¿seguir los dos rayos, o uno de ellos al azar?",
    ));
    sheet.equation(
        "L = F L _ r + ( 1 − F ) L _ t",
        text(
            "Whitted 1980. What glass sends to the eye is the share F of what it reflects and the rest of what it transmits. Recursive ray tracing takes both terms: the rays of a sample form a tree. A path takes one of them with the \
             probability that is its weight. Both have the same expectation, and account for direct light alone, also as mirrors and glass show it.",
            "Whitted 1980. Lo que el vidrio envía al ojo es la fracción F de lo que refleja y el resto de lo que transmite. El trazado de rayos recursivo toma ambos términos: los rayos de una muestra forman un árbol. Un camino toma uno de ellos \
             con una probabilidad igual a su peso. Ambos tienen la misma esperanza, y solo dan cuenta de la luz directa, también la que se ve a \
             través de espejos y vidrios.",
        ),
    );
    let reference = lab.render("branching-reference", SPHERES.shot("whitted").samples(4096).with_own_seed())?;
    let both = lab.render("branching-both", SPHERES.shot("whitted").samples(128))?;
    let one = with_rays_of(lab, "branching-one", "whitted:branches=one", &both)?;
    let path = with_rays_of(lab, "branching-path", "path", &both)?;
    let full = SPHERES.reference(lab)?;
    let mut cells = Vec::new();
    let mut glass = Vec::new();
    for (run, reference, title) in [
        (&both, &reference, text("Tree: both branches", "Árbol: ambas ramas")),
        (&one, &reference, text("One branch by chance", "Una rama al azar")),
        (&path, &full, text("Path tracing: all light", "Trazado de caminos: toda la luz")),
    ] {
        let found = lab.compare(run, reference)?;
        glass.push(compare(&part_of(&run.image, GLASS), &part_of(&reference.image, GLASS))?.relmse);
        let millions = figure(run.rays() / 1e6);
        let caption = vec![
            relmse(&found),
            text(format!("{millions} million rays"), format!("{millions} millones de rayos")),
            text(
                format!("{} rays per sample", figure(run.rays_per_sample())),
                format!("{} rayos por muestra", figure(run.rays_per_sample())),
            ),
            spp(run),
            seconds(run),
        ];
        cells.push(picture(run, SPHERES.exposure, title.clone(), SPHERES.alt(&title), caption));
    }
    sheet.gallery(3, cells, exposure_note(SPHERES.exposure))?;
    let [both_glass, one_glass] = [figure(glass[0]), figure(glass[1])];
    sheet.say(text(
        "The number of samples of the second and the third picture was chosen so that all three trace the same number of rays: the first one's \
         rays over the rays of a sample, which a short rendering told.",
        "El número de muestras de la segunda y la tercera imagen se eligió para que las tres tracen el mismo número de rayos: los de la \
         primera entre los rayos de una muestra, que se midieron con un cálculo breve.",
    ));
    sheet.see(text(
        format!(
            "On the glass sphere the tree has a relMSE of {both_glass}, one branch by chance {one_glass} with as many rays; what \
             the single branch saves in the glass buys it more samples everywhere else. Neither shows the caustic, light on the ceiling, or colour bleeding: \
             below the sphere lies a plain shadow. The path that goes on after every surface shows all of it for the same rays."
        ),
        format!(
            "En la esfera de vidrio, el árbol tiene un relMSE de {both_glass}; una rama al azar, de {one_glass} con los mismos rayos; lo que la \
             rama única ahorra en el vidrio le da más muestras en todo lo demás. Ninguno muestra la cáustica, la luz del techo ni el color que las paredes \
             se prestan: bajo la esfera queda una simple sombra. El camino que continúa tras cada superficie lo muestra todo con los mismos rayos."
        ),
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}

/// A rendering with as many samples as take the rays of another one.
fn with_rays_of(lab: &mut Lab, name: &str, technique: &str, like: &Run) -> Result<Rc<Run>> {
    let pilot = lab.render(&format!("{name}-pilot"), SPHERES.shot(technique).samples(PILOT))?;
    let spp = (like.rays() / (pilot.rays() / pilot.spp())).round().max(1.0);
    lab.render(name, SPHERES.shot(technique).samples(spp as u32).that_was_measured())
}
