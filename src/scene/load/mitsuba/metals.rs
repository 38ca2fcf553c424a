//! Conductors by name: the complex indices of refraction of what Mitsuba's documentation lists for `conductor`.

/// Names, real part and imaginary part in linear sRGB.
type Metal = (&'static [&'static str], [f64; 3], [f64; 3]);

/// Averages over each channel of published measurements (Palik 1998; the atomic scattering factors of CXRO and LLNL), as
/// evaluated by Mitsuba 3.9's RGB mode: the spectrum's colour under illuminant E, clamped at 0. Not all of them conduct;
/// what transmits in truth only reflects here.
const METALS: [Metal; 38] = [
    (&["a-C"], [2.94405, 2.22714, 1.96816], [0.887465, 0.799299, 0.81529]),
    (&["Ag"], [0.155276, 0.116728, 0.138388], [4.82835, 3.12222, 2.1469]),
    (&["Al"], [1.6575, 0.880405, 0.521244], [9.22381, 6.2695, 4.837]),
    (&["AlAs", "AlAs_palik"], [3.6053, 3.23294, 2.21632], [6.79437e-04, 0.0, 0.00751271]),
    (&["AlSb", "AlSb_palik"], [0.0, 4.13937, 4.66925], [0.0, 0.0940091, 1.30057]),
    (&["Au"], [0.143036, 0.375307, 1.44205], [3.983, 2.38556, 1.60336]),
    (&["Be", "Be_palik"], [4.18501, 3.18503, 2.78406], [3.83547, 3.01012, 2.86899]),
    (&["Cr"], [4.36967, 2.91651, 1.6549], [5.20655, 4.23131, 3.7547]),
    (&["CsI", "CsI_palik"], [2.1449, 1.70232, 1.66243], [0.0, 0.0, 0.0]),
    (&["Cu"], [0.201005, 0.92375, 1.10222], [3.91326, 2.45305, 2.14209]),
    (&["Cu_palik"], [0.213229, 0.919715, 1.10241], [3.92187, 2.45733, 2.13658]),
    (&["Cu2O", "Cu2O_palik"], [3.55177, 2.94987, 2.75188], [0.114207, 0.193897, 0.606134]),
    (&["CuO", "CuO_palik"], [3.24754, 2.44781, 2.21022], [0.52109, 0.570031, 0.722179]),
    (&["d-C", "d-C_palik"], [2.70872, 2.31883, 2.2289], [0.0, 0.0, 0.0]),
    (&["Hg", "Hg_palik"], [2.39894, 1.44003, 0.90957], [6.32759, 4.37192, 3.42176]),
    (&["HgTe", "HgTe_palik"], [4.77904, 3.2312, 2.6599], [1.63161, 1.58081, 1.72929]),
    (&["Ir", "Ir_palik"], [3.0863, 2.08219, 1.61791], [5.59215, 4.06709, 3.26731]),
    (&["K", "K_palik"], [0.0640432, 0.0464098, 0.0381849], [2.1042, 1.34894, 0.913126]),
    (&["Li", "Li_palik"], [0.265791, 0.195618, 0.220949], [3.54015, 2.31112, 1.66861]),
    (&["MgO", "MgO_palik"], [2.08958, 1.65072, 1.59488], [0.0, 0.0, 0.0]),
    (&["Mo", "Mo_palik"], [4.48397, 3.52513, 2.77631], [4.11144, 3.42083, 3.15061]),
    (&["Na_palik"], [0.0602694, 0.0561409, 0.0619884], [3.17927, 2.11249, 1.57904]),
    (&["Nb", "Nb_palik"], [3.42007, 2.79009, 2.39563], [3.44139, 2.73767, 2.57975]),
    (&["Ni_palik"], [2.3673, 1.66337, 1.46708], [4.49881, 3.05015, 2.34544]),
    (&["Rh", "Rh_palik"], [2.58579, 1.86022, 1.55426], [6.78226, 4.70299, 3.97607]),
    (&["Se", "Se_palik"], [4.05831, 2.84294, 2.82085], [0.75405, 0.638444, 0.521808]),
    (&["SiC", "SiC_palik"], [3.17234, 2.52597, 2.47937], [7.53766e-07, 0.0, 1.01925e-05]),
    (&["SnTe", "SnTe_palik"], [4.52425, 1.98164, 1.28159], [0.0, 0.0, 0.0]),
    (&["Ta", "Ta_palik"], [2.06272, 2.39294, 2.62793], [2.40836, 1.74149, 1.94703]),
    (&["Te", "Te_palik"], [7.39023, 4.4821, 2.63711], [3.25602, 3.52706, 3.29205]),
    (&["ThF4", "ThF4_palik"], [1.83071, 1.44223, 1.38765], [0.0, 0.0, 0.0]),
    (&["TiC", "TiC_palik"], [3.70053, 2.83742, 2.58229], [3.26564, 2.35159, 2.17279]),
    (&["TiN", "TiN_palik"], [1.64845, 1.15052, 1.37982], [3.36833, 1.9435, 1.10207]),
    (&["TiO2", "TiO2_palik"], [3.45661, 2.80174, 2.90517], [1.05265e-04, 0.0, 6.52887e-04]),
    (&["VC", "VC_palik"], [3.65757, 2.75274, 2.53267], [3.0683, 2.19869, 1.96319]),
    (&["V_palik"], [4.27758, 3.51295, 2.76107], [3.4913, 2.88945, 3.11152]),
    (&["VN", "VN_palik"], [2.8656, 2.11919, 1.94009], [3.03224, 2.05612, 1.61631]),
    (&["W"], [4.37082, 3.30025, 2.99841], [3.50064, 2.60487, 2.27323]),
];

/// The complex index of refraction of a named conductor, `(eta, k)` in linear sRGB. `none` is a perfect mirror.
pub(super) fn index_of_refraction(name: &str) -> Option<([f64; 3], [f64; 3])> {
    if name == "none" {
        return Some(MIRROR);
    }
    METALS.iter().find(|(names, ..)| names.contains(&name)).map(|(_, eta, k)| (*eta, *k))
}

/// An index whose Fresnel reflectance is 1 at every angle.
pub(super) const MIRROR: ([f64; 3], [f64; 3]) = ([0.0; 3], [1.0; 3]);

/// All names, for messages.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    ["none"].into_iter().chain(METALS.iter().flat_map(|(names, ..)| names.iter().copied()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn names_are_found_once() {
        let mut all: Vec<&str> = names().collect();
        assert_eq!(all.len(), 66);
        assert!(all.iter().all(|name| index_of_refraction(name).is_some()));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 66, "a name stands for one material");
        assert_eq!(index_of_refraction("Unobtainium"), None);
    }

    /// Reflectance at normal incidence, ((eta - 1)² + k²) / ((eta + 1)² + k²), against what the metals look like: silver
    /// and aluminium reflect above 0.87 without a hue, gold and copper keep the blue back.
    #[test]
    fn metals_have_their_colours() {
        let reflectance = |name: &str| {
            let (eta, k) = index_of_refraction(name).unwrap();
            [0, 1, 2].map(|channel| {
                let (eta, k2) = (eta[channel], k[channel] * k[channel]);
                ((eta - 1.0).powi(2) + k2) / ((eta + 1.0).powi(2) + k2)
            })
        };
        assert_eq!(reflectance("none"), [1.0; 3]);
        for name in ["Ag", "Al"] {
            assert!(reflectance(name).iter().all(|channel| *channel > 0.87), "{name}: {:?}", reflectance(name));
        }
        for name in ["Au", "Cu"] {
            let [r, g, b] = reflectance(name);
            assert!(r > 0.93 && g < r - 0.1 && b < g - 0.05, "{name}: {:?}", [r, g, b]);
        }
    }
}
