//! The strategies (s, t) of bidirectional path tracing, without and with weights.

use super::prelude::*;
use super::scenes::SPHERES;
use crate::lecture::run::average;
use crate::lecture::sheet::figure_of_percent;
use crate::techniques::Strategies;

pub const CHAPTER: Chapter = Chapter {
    name: "strategies",
    titles: ("The (s, t) pyramid, without and with weights", "La pirámide (s, t), sin pesos y con ellos"),
    needs: &["bdpt"],
    write,
};

/// Longest paths of the pyramid, in segments.
const LONGEST: u32 = 5;
/// Side of its pictures.
const SIDE: u32 = 80;
/// Samples of the three ways to combine.
const SAMPLES: u32 = 64;

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "A path of k segments can be made in k + 1 ways. Which of them finds which light, and how are they put together?",
        "Un camino de k segmentos se puede construir de k + 1 maneras. ¿Cuál encuentra qué luz, y cómo se combinan?",
    ));
    sheet.equation(
        "I ≈ ∑ _ { s , t } w _ { s , t } { f ( X ) } over { p _ { s , t } ( X ) } , w _ { s , t } = { p _ { s , t } ^ 2 } over { ∑ _ { i } p _ { i , k + 1 − i } ^ 2 }",
        text(
            "Veach 1997, chapter 10: s vertices from the lamp, t = k + 1 − s from the camera, joined by a shadow ray. Every strategy alone is an \
             unbiased estimate where it finds the light at all; the weights give each path to the strategies that make it most often.",
            "Veach 1997, capítulo 10: s vértices desde la lámpara y t = k + 1 − s desde la cámara, unidos por un rayo de sombra. Cada estrategia por sí \
             sola es un estimador insesgado allí donde encuentra la luz; los pesos asignan cada camino a las estrategias que lo generan más a menudo.",
        ),
    );
    pyramids(lab, sheet)?;
    weights(lab, sheet)
}

fn pyramids(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    let options = format!("--strategies={LONGEST} --max-depth {LONGEST}");
    let shot = SPHERES.shot("bdpt").samples(256).size(SIDE, SIDE).with(&options);
    let run = lab.render("strategies", shot)?;
    let total = average(&run.image);
    let strategies = Strategies { longest: LONGEST, lens: false };
    for (kind, suffix, heading, what) in [
        (
            "alone",
            "_unweighted",
            text("Each strategy alone", "Cada estrategia por sí sola"),
            text("by itself", "por sí sola"),
        ),
        ("weighted", "", text("Each weighted", "Cada una con su peso"), text("weighted", "ponderada")),
    ] {
        sheet.heading(heading);
        let mut rows: Vec<Vec<Cell>> = Vec::new();
        for segments in 1..=LONGEST {
            let mut row = Vec::new();
            for strategy in strategies.all().filter(|strategy| strategy.segments() == segments) {
                let layer = run.layer(&format!("{}{suffix}", strategy.name()))?;
                let title = format!("s={}, t={}", strategy.s, strategy.t);
                let alt = what.map(|what| format!("{title}, {what}"));
                let share = same(figure_of_percent(average(&layer) / total));
                let name = format!("strategy-{}-{kind}", strategy.name());
                row.push(image(&name, &layer, SPHERES.exposure, same(title), SPHERES.alt(&alt), vec![share]));
            }
            rows.push(row);
        }
        sheet.pyramid(rows, text(
            format!("One row for each path length, from 1 to {LONGEST} segments. Exposure ×{}. Below each: its mean over that of the image.", SPHERES.exposure),
            format!("Una fila por longitud de camino, de 1 a {LONGEST} segmentos. Exposición ×{}. Debajo de cada una, su media entre la de la imagen.", SPHERES.exposure),
        ))?;
    }
    sheet.see(text(
        "In a row of the first pyramid all pictures show the same light, as far as the strategy finds it: the left end (s = 0) waits for a lamp to be \
         hit and has the mirror and the glass right; the right end (t = 1) is light tracing and has the caustic. In the second one each keeps what it is \
         good at: the grain is gone from where another strategy is better, and a row now sums to the light of its length.",
        "En una fila de la primera pirámide, todas las imágenes muestran la misma luz, en la medida en que la estrategia la encuentra: el extremo izquierdo \
         (s = 0) espera a dar con una lámpara y acierta con el espejo y el vidrio; el derecho (t = 1) es el trazado de luz y acierta con la cáustica. En la \
         segunda, cada una conserva lo que se le da bien: el grano desaparece donde otra estrategia es mejor, y la fila suma la luz de su longitud.",
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}

/// The whole image by each way to combine the strategies.
fn weights(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.heading(text("All strategies together", "Todas las estrategias juntas"));
    let reference = SPHERES.reference(lab)?;
    let mut cells = Vec::new();
    let mut errors = Vec::new();
    for (weights, title) in [
        ("none", text("Plain mean", "Media simple")),
        ("balance", text("Balance heuristic", "Heurística de equilibrio")),
        ("power", text("Power heuristic", "Heurística de potencia")),
    ] {
        let shot = SPHERES.shot(format!("bdpt:weights={weights}")).samples(SAMPLES);
        let run = lab.render(&format!("strategies-{weights}"), shot)?;
        let found = lab.compare(&run, &reference)?;
        errors.push(found.relmse());
        cells.push(picture(&run, SPHERES.exposure, title.clone(), SPHERES.alt(&title), error_caption(&run, &found)));
    }
    sheet.gallery(3, cells, exposure_note(SPHERES.exposure))?;
    let gain = figure(errors[0] / errors[2]);
    sheet.see(text(
        format!(
            "All three have the same expectation. The plain mean keeps the grain of the worst strategy: {gain} times the squared error of the power \
             heuristic at the same number of samples."
        ),
        format!(
            "Las tres tienen la misma esperanza. La media simple conserva el grano de la peor estrategia: {gain} veces el error al cuadrado de la heurística de \
             potencia con el mismo número de muestras."
        ),
    ));
    sheet.commands(&lab.take_commands());
    Ok(())
}
