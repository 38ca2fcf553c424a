//! What the table of techniques says, in Spanish.

/// A technique: what it solves, its bias, what it is good and bad at.
type Words = [&'static str; 4];

const TECHNIQUES: &[(&str, Words)] = &[
    (
        "direct",
        [
            "emisión y luz directa",
            "insesgada",
            "sombras suaves, y ver por separado cada manera de muestrearlas",
            "habitaciones: en ella nada ha rebotado dos veces",
        ],
    ),
    (
        "whitted",
        [
            "emisión y luz directa, también la que muestran los espejos y el vidrio liso",
            "insesgada",
            "espejos y vidrio claro bajo luz directa: una muestra sigue todas las ramas",
            "la luz entre superficies mates y la que un vidrio deja pasar hasta ellas: no tiene ninguna de las dos",
        ],
    ),
    (
        "path-implicit",
        [
            "todo el transporte de luz",
            "insesgada",
            "lámparas y cielos tan grandes que el azar los encuentra; es el trazador más corto de leer",
            "lámparas pequeñas, que el azar rara vez encuentra",
        ],
    ),
    (
        "path",
        [
            "todo el transporte de luz",
            "insesgada",
            "la mayoría de las escenas: siempre que los caminos de la cámara puedan apuntar a la luz",
            "cáusticas, y lámparas escondidas en sus pantallas",
        ],
    ),
    (
        "path-recursive",
        [
            "todo el transporte de luz",
            "insesgada",
            "leer la ecuación de render en el código",
            "la velocidad: lo que esperan sus llamadas se guarda en memoria",
        ],
    ),
    (
        "light",
        [
            "todo el transporte de luz",
            "insesgada",
            "cáusticas sobre superficies mates que la cámara ve directamente",
            "espejos y vidrios, que quedan negros, y habitaciones de las que la cámara ve poco",
        ],
    ),
    (
        "bdpt",
        [
            "todo el transporte de luz",
            "insesgada",
            "lámparas con pantalla, habitaciones iluminadas a través de una pared, cáusticas vistas directamente",
            "luz a la que es fácil apuntar, pues cada muestra tarda varias veces más; cáusticas vistas en espejos",
        ],
    ),
    (
        "vcm",
        [
            "todo el transporte de luz",
            "consistente: desenfocada en un radio que mengua con cada muestra",
            "toda clase de luz en una imagen, incluidas las cáusticas vistas en espejos y las superficies satinadas",
            "luz a la que es fácil apuntar: sus muestras son las que más tardan",
        ],
    ),
    (
        "photon",
        [
            "todo el transporte de luz",
            "consistente: desenfocada en un radio que mengua con cada muestra",
            "cáusticas, también como las muestran los espejos y los vidrios",
            "superficies satinadas, y luz a la que es fácil apuntar",
        ],
    ),
    (
        "mlt",
        [
            "todo el transporte de luz",
            "consistente: la media por la que se escalan las visitas de sus cadenas se estima con los mismos caminos",
            "salas iluminadas a través de una pared: un camino difícil de encontrar lleva a sus vecinos",
            "luz a la que es fácil apuntar, donde volver a los mismos caminos dice poco de nuevo; luz que solo el azar encuentra",
        ],
    ),
    (
        "radiosity",
        [
            "todo el transporte de luz, tomando por difusas todas las superficies",
            "sesgada: las superficies son difusas y cada parche tiene una sola irradiancia; con parches menores se vuelve exacta",
            "habitaciones difusas: toda su luz desde cualquier lado, sin ruido una vez resuelta",
            "sombras nítidas, que los parches desenfocan, y todo lo que no es difuso, que trata como si lo fuera",
        ],
    ),
];

/// The words for a technique of that name.
pub fn of(name: &str) -> Option<Words> {
    TECHNIQUES.iter().find(|(known, _)| *known == name).map(|(_, words)| *words)
}

#[cfg(test)]
mod tests {
    use crate::techniques::TECHNIQUES;

    #[test]
    fn every_technique_has_spanish_words() {
        for row in TECHNIQUES {
            assert!(super::of(row.name).is_some(), "src/lecture/chapters/spanish.rs lacks {}", row.name);
        }
    }
}
