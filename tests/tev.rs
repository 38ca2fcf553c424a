//! `lumbre render --tev` against a viewer that is a few lines: what it is shown, and that a rendering does without it.

use std::io::Read;
use std::net::{TcpListener, TcpStream};
use std::thread::JoinHandle;

use lumbre::image::{Image, read_image};

use crate::common::program::{fails, render, works};

/// What the viewer was sent of one picture.
#[derive(Default)]
struct Shown {
    name: String,
    image: Option<Image>,
    /// How often all of it was sent.
    updates: usize,
}

/// The next bytes of a packet.
struct Bytes(Vec<u8>);

impl Bytes {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let rest = self.0.split_off(N);
        std::mem::replace(&mut self.0, rest).try_into().unwrap()
    }

    fn int(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn long(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    fn text(&mut self) -> String {
        let mut text = Vec::new();
        loop {
            match self.take::<1>()[0] {
                0 => return String::from_utf8(text).unwrap(),
                byte => text.push(byte),
            }
        }
    }
}

/// The next packet, as the documentation of tev has it: its length with the four bytes that say so, then its type; nothing at the end.
fn packet(stream: &mut TcpStream) -> Option<(u8, Bytes)> {
    let mut length = [0; 4];
    stream.read_exact(&mut length).ok()?;
    let mut body = vec![0; u32::from_le_bytes(length) as usize - 4];
    stream.read_exact(&mut body).unwrap();
    let mut bytes = Bytes(body);
    let kind = bytes.take::<1>()[0];
    Some((kind, bytes))
}

fn watch(mut stream: TcpStream) -> Shown {
    let mut shown = Shown::default();
    while let Some((kind, mut bytes)) = packet(&mut stream) {
        let _grabs_focus = bytes.take::<1>();
        let name = bytes.text();
        match kind {
            4 => {
                let (width, height, channels) = (bytes.int(), bytes.int(), bytes.int());
                let names: Vec<String> = (0..channels).map(|_| bytes.text()).collect();
                assert_eq!(names, ["R", "G", "B"]);
                let pixels = vec![[0.0; 3]; width as usize * height as usize];
                shown = Shown { name, image: Some(Image { width, height, pixels }), updates: 0 };
            }
            6 => {
                assert_eq!(name, shown.name);
                let channels = bytes.int() as usize;
                let names: Vec<String> = (0..channels).map(|_| bytes.text()).collect();
                assert_eq!(names, ["R", "G", "B"]);
                let [x, y, width, height] = std::array::from_fn(|_| bytes.int());
                let offsets: Vec<usize> = (0..channels).map(|_| bytes.long() as usize).collect();
                let strides: Vec<usize> = (0..channels).map(|_| bytes.long() as usize).collect();
                let data: Vec<f32> =
                    bytes.0.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
                let image = shown.image.as_mut().unwrap();
                for pixel in 0..(width * height) as usize {
                    let (column, row) = (x as usize + pixel % width as usize, y as usize + pixel / width as usize);
                    image.pixels[row * image.width as usize + column] =
                        std::array::from_fn(|channel| data[offsets[channel] + pixel * strides[channel]]);
                }
                shown.updates += usize::from(y + height == image.height);
            }
            other => panic!("a packet of type {other}"),
        }
    }
    shown
}

/// A viewer for one connection, and its address.
fn viewer<T: Send + 'static>(watch: impl FnOnce(TcpStream) -> T + Send + 'static) -> (String, JoinHandle<T>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    (address, std::thread::spawn(move || watch(listener.accept().unwrap().0)))
}

#[test]
fn the_viewer_is_shown_the_picture_in_progress_and_the_final_one() {
    let folder = tempfile::tempdir().unwrap();
    let (address, watching) = viewer(watch);
    works(render(folder.path(), "cornell.xml", &format!("-t 2 --size 400x300 -o a.exr --tev {address}")));
    let shown = watching.join().unwrap();
    assert_eq!(shown.name, "cornell.xml path");
    // In two packets each: 360,000 numbers are more than one holds.
    assert!((2..=6).contains(&shown.updates), "{} updates in two seconds", shown.updates);
    assert_eq!(shown.image.unwrap(), read_image(&folder.path().join("a.exr")).unwrap());
}

/// A viewer that is not there, or goes away, is one warning: the picture is there all the same.
#[test]
fn a_rendering_does_without_the_viewer() {
    let folder = tempfile::tempdir().unwrap();
    let warns = |address: &str, what: &str| {
        let said =
            works(render(folder.path(), "cornell.xml", &format!("-t 1.5 --size 48x32 -o a.exr --tev {address}")));
        let warnings: Vec<&str> = said.lines().filter(|line| line.starts_with("warning: ")).collect();
        assert!(warnings.len() == 1 && warnings[0].contains(what) && warnings[0].contains(address), "{said}");
        assert!(read_image(&folder.path().join("a.exr")).is_ok());
    };
    let (address, leaving) = viewer(|mut stream| packet(&mut stream).is_some());
    warns(&address, "has gone away");
    assert!(leaving.join().unwrap());
    // Nobody listens there any more.
    warns(&address, "no tev answers");
    for wrong in ["localhost", "localhost:", ":14158", "localhost:0", "localhost:x"] {
        let said = fails(render(folder.path(), "cornell.xml", &format!("-n 1 --tev {wrong}")), 2);
        assert!(said.contains("it must be HOST:PORT, such as localhost:14158"), "{said}");
    }
}
