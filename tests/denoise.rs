//! `lumbre render --denoise`, and the layers that denoisers take, by Open Image Denoise where there is a library of it.

use std::path::PathBuf;
use std::process::Command;

use lumbre::image::metrics::compare;
use lumbre::image::{read_image, read_layer};
use lumbre::techniques::{Correlated, TECHNIQUES};

use crate::common::program::{fails, render, works};

/// A Python that has Open Image Denoise (`LUMBRE_TEST_PYTHON` names one), and the folder of its library.
fn python() -> Option<(String, PathBuf)> {
    let python = std::env::var("LUMBRE_TEST_PYTHON").unwrap_or_else(|_| String::from("python3"));
    let ask = "import pyoidn, OpenEXR, numpy, os; print(os.path.join(os.path.dirname(pyoidn.__file__), 'oidn', 'lib'))";
    let output = Command::new(&python).args(["-c", ask]).output().ok().filter(|output| output.status.success());
    let Some(output) = output else {
        eprintln!("not tested: {python} has no pyoidn, OpenEXR and numpy");
        return None;
    };
    Some((python, PathBuf::from(String::from_utf8(output.stdout).unwrap().trim())))
}

/// With albedo and normals denoising leaves less than a quarter of the error, and it comes to the same by the program itself as in Python.
#[test]
fn open_image_denoise_takes_the_layers() {
    let Some((python, library)) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let with_library = |args: &str| {
        let mut command = render(folder.path(), "cornell.xml", args);
        command.env("LD_LIBRARY_PATH", &library);
        command
    };
    works(render(folder.path(), "cornell.xml", "-n 4 --size 64x64 --aov albedo,normal -o noisy.exr -o noisy.png"));
    works(render(folder.path(), "cornell.xml", "-n 256 --seed 7 --size 64x64 -o reference.exr"));
    works(with_library("-n 4 --size 64x64 --denoise -o own.exr -o own.png --json own.json"));
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/denoise.py");
    let output = Command::new(&python)
        .args([script, "noisy.exr", "denoised.exr", "--reference", "reference.exr"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    let error = |what: &str| -> f64 {
        let line = said.lines().find(|line| line.ends_with(what)).unwrap_or_else(|| panic!("{said}"));
        line.split_whitespace().nth(1).unwrap().parse().unwrap()
    };
    let denoised_error = error("denoised with albedo and normal");
    assert!(denoised_error < 0.25 * error("noisy"), "{said}");

    let path = |name: &str| folder.path().join(name);
    let [own, theirs, noisy, reference] =
        ["own", "denoised", "noisy", "reference"].map(|name| read_image(&path(&format!("{name}.exr"))).unwrap());
    let difference = compare(&own, &theirs).unwrap().relmse;
    let without = (error("denoised without layers") - denoised_error).abs();
    assert!(difference < 1e-9 && without > 1e-6, "{difference}, {without}: {said}");
    assert!(compare(&own, &reference).unwrap().relmse < 0.25 * compare(&noisy, &reference).unwrap().relmse);
    // The image as it was is a layer; the PNG is denoised, too.
    assert_eq!(read_layer(&path("own.exr"), "noisy").unwrap(), Some(noisy));
    assert_ne!(read_image(&path("own.png")).unwrap(), read_image(&path("noisy.png")).unwrap());
    assert!(std::fs::read_to_string(path("own.json")).unwrap().contains(r#""denoiser": "Open Image Denoise 2."#));
}

#[test]
fn without_a_library_denoising_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = render(folder.path(), "cornell.xml", "-n 1 --size 16x16 --denoise -o a.exr");
    command.env_remove("LD_LIBRARY_PATH");
    if command.output().unwrap().status.success() {
        eprintln!("not tested: Open Image Denoise is installed");
        return;
    }
    let said = fails(command, 1);
    assert!(said.contains("libOpenImageDenoise.so.2") && said.contains("www.openimagedenoise.org"), "{said}");
    assert!(!folder.path().join("a.exr").exists());
}

#[test]
fn correlated_noise_is_not_denoised() {
    let folder = tempfile::tempdir().unwrap();
    let correlated: Vec<_> = TECHNIQUES.iter().filter(|row| row.correlated != Correlated::Nothing).collect();
    assert!(correlated.len() > 3);
    for row in correlated {
        let said = fails(render(folder.path(), "cornell.xml", &format!("-i {} -n 1 --denoise", row.name)), 2);
        assert!(said.contains(&format!("--denoise with {}", row.name)) && said.contains("light or bdpt"), "{said}");
    }
    let said = fails(render(folder.path(), "cornell.xml", "-n 1 --denoise --lengths -o a.exr"), 2);
    assert!(said.contains("'--denoise' cannot be used with '--lengths"), "{said}");
}
