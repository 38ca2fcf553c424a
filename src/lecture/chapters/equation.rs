//! The rendering equation, and what a Monte Carlo estimate of it does with more samples.

use super::prelude::*;
use super::scenes::CORNELL;
use crate::lecture::command::Shot;
use crate::lecture::math::inline;
use crate::lecture::sheet::Curve;

pub const CHAPTER: Chapter =
    Chapter { name: "equation", titles: ("The rendering equation", "La ecuación de render"), needs: &["path"], write };

/// Samples per pixel of the pictures.
const STEPS: [u32; 6] = [1, 4, 16, 64, 256, 1024];

fn write(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.question(text(
        "What does a picture of light have to fulfil, and what does a renderer that draws random numbers make of it?",
        "¿Qué debe cumplir una imagen de la luz, y qué hace con ello un programa que tira números al azar?",
    ));
    sheet.equation(
        "L _ o ( x , ω ) = L _ e ( x , ω ) + ∫ _ Ω f ( x , ω ′ , ω ) L _ i ( x , ω ′ ) | cos θ ′ | d ω ′",
        text(
            "Kajiya 1986. Light that leaves x is what x emits, and what it scatters of all light that arrives there. What arrives left \
             another point: the unknown stands on both sides, and the solution is a sum over paths of all lengths.",
            "Kajiya 1986. La luz que sale de x es la que x emite más la que dispersa de toda la que le llega. Lo que llega salió de otro \
             punto: la incógnita está en ambos lados, y la solución es una suma sobre caminos de todas las longitudes.",
        ),
    );
    sheet.equation(
        "I ≈ { 1 } over { N } ∑ _ { i = 1 } ^ N { f ( X _ i ) } over { p ( X _ i ) } , σ ∝ { 1 } over { N ^ { 1 / 2 } }",
        text(
            "The Monte Carlo estimate of a pixel: the mean over N random paths of the contribution of each over the density with which it was \
             chosen. Its expectation is right at any N. Its error falls with the root of N, its squared error with N.",
            "El estimador de Monte Carlo de un píxel: la media, sobre N caminos al azar, de lo que cada uno aporta entre la densidad con \
             que se eligió. Su esperanza es correcta con cualquier N. Su error baja con la raíz de N, y el error al cuadrado, con N.",
        ),
    );
    noise(lab, sheet)?;
    furnace(lab, sheet)
}

fn noise(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    let reference = CORNELL.reference(lab)?;
    let (mut cells, mut points) = (Vec::new(), Vec::new());
    for steps in STEPS {
        let run = lab.render(&format!("equation-{steps}"), CORNELL.shot("path").samples(steps))?;
        let found = lab.compare(&run, &reference)?;
        points.push((run.spp(), found.relmse()));
        let title = text(
            format!("{} samples per pixel", samples(run.spp())),
            format!("{} muestras por píxel", samples(run.spp())),
        );
        let title = if steps == 1 { text("1 sample per pixel", "1 muestra por píxel") } else { title };
        cells.push(picture(
            &run,
            CORNELL.exposure,
            title.clone(),
            CORNELL.alt(&title),
            vec![relmse(&found), seconds(&run)],
        ));
    }
    sheet.gallery(6, cells, exposure_note(CORNELL.exposure))?;
    let curve = Curve { name: text("path tracing", "trazado de caminos"), points: points.clone() };
    sheet.chart(
        [text("samples per pixel", "muestras por píxel"), same("relMSE")],
        &text(
            "relMSE over samples per pixel: a straight line of slope −1",
            "relMSE según las muestras por píxel: una recta de pendiente −1",
        ),
        &[curve],
        (-1.0, &text("slope −1", "pendiente −1")),
    );
    if let (Some(first), Some(last)) = (points.first(), points.last()) {
        let gain = figure(first.1 / last.1);
        let work = samples(last.0 / first.0);
        sheet.see(text(
            format!(
                "The same picture under ever finer grain. {work} times the samples made the squared error {gain} times smaller: four times \
                 the work for half the noise. Everything that follows is about making the noise of one sample smaller, or the \
                 sample cheaper."
            ),
            format!(
                "La misma imagen bajo un grano cada vez más fino. Con {work} veces más muestras, el error al cuadrado es {gain} veces \
                 menor: el cuádruple de trabajo para la mitad de ruido. Todo lo que sigue trata de que cada muestra tenga menos \
                 ruido, o de que cueste menos."
            ),
        ));
    }
    sheet.commands(&lab.take_commands());
    Ok(())
}

/// A room where the equation can be solved by hand.
fn furnace(lab: &mut Lab, sheet: &mut Sheet) -> Result<()> {
    sheet.heading(text("Where the answer is known", "Donde se conoce la respuesta"));
    sheet.say(text(
        format!(
            "Inside a closed room whose walls emit {} and reflect the share ρ of what arrives, radiance is the same everywhere: \
             the equation becomes {}, a geometric series whose k-th term is light of k segments. The three channels have three albedos.",
            inline("L _ e = 1"),
            inline("L = L _ e + ρ L = L _ e / ( 1 − ρ )")
        ),
        format!(
            "Dentro de una habitación cerrada cuyas paredes emiten {} y reflejan la fracción ρ de lo que les llega, la radiancia es igual en \
             todas partes: la ecuación se reduce a {}, una serie geométrica cuyo término k es la luz de k segmentos. Los tres \
             canales tienen tres albedos.",
            inline("L _ e = 1"),
            inline("L = L _ e + ρ L = L _ e / ( 1 − ρ )")
        ),
    ));
    let run =
        lab.render("equation-furnace", Shot::new("furnace_box", "path").samples(1024).size(64, 64).with_errors())?;
    let variance = run.layer("variance")?;
    let pixels = variance.pixels.len().max(1) as f64;
    let (means, variances) = (run.image.average(), variance.average());
    // The albedos of scenes/furnace_box.xml.
    let rows = [0.5, 0.25, 0.75].iter().zip(means.iter().zip(variances)).map(|(albedo, (mean, variance))| {
        let error = (variance / pixels).sqrt();
        vec![
            same(format!("ρ = {albedo}")),
            same(format!("{:.5}", 1.0 / (1.0 - albedo))),
            same(format!("{mean:.5} ± {error:.5}")),
        ]
    });
    let rows: Vec<Vec<Text>> = rows.collect();
    sheet.table(&[text("albedo", "albedo"), text("expected", "esperado"), text("measured", "medido")], &rows);
    sheet.commands(&lab.take_commands());
    Ok(())
}
