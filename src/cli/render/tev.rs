//! `--tev`: the picture in progress in the viewer tev (<https://github.com/Tom94/tev>), by its protocol over TCP.

use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

use lumbre::error::Result;
use lumbre::image::Image;
use lumbre::render::{Renderer, Settings};
use lumbre::scene::Scene;

use crate::cli::output::say;

/// The port that tev listens at unless it is told another.
const USUAL_PORT: u16 = 14158;
/// How long tev may take to answer, and to take an update.
const PATIENCE: Duration = Duration::from_secs(3);
/// Between two updates at least.
const INTERVAL: Duration = Duration::from_millis(500);
/// Reading the picture for updates takes at most this part of the time.
const SHARE: u32 = 20;
/// Bytes of pixels in a packet at most: the protocol counts those of a packet in 32 bits.
const PACKET: usize = 1 << 20;
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A viewer that is shown the picture while it becomes one, from a thread of its own. Without one, or once it has gone away, nothing happens.
pub(super) struct Viewer {
    pictures: Option<SyncSender<Image>>,
    showing: Option<JoinHandle<()>>,
    next: Instant,
}

impl Viewer {
    /// Looks for tev at an address and has it open a black picture, named after the scene's file and the technique. That it is not there
    /// is a warning.
    pub fn new(address: Option<&str>, scene: &Scene, settings: &Settings, quiet: bool) -> Self {
        let mut viewer = Self { pictures: None, showing: None, next: Instant::now() };
        let Some(address) = address.map(str::to_owned) else { return viewer };
        let file = scene.source.file_name().unwrap_or(scene.source.as_os_str()).to_string_lossy();
        let name = format!("{file} {}", settings.technique.describe());
        match open(&address, &name, settings) {
            Ok(client) => {
                // A picture is handed over only to a thread that waits for one.
                let (sender, pictures) = sync_channel(0);
                viewer.pictures = Some(sender);
                viewer.showing =
                    Some(std::thread::spawn(move || show_all(client, &pictures, (&name, &address), quiet)));
            }
            Err(error) => warn(quiet, &format!("no tev answers at {address}: {error}")),
        }
        viewer
    }

    /// Shows what there is, where it is time for that and tev has taken what it was sent before.
    pub fn offer(&mut self, renderer: &Renderer) -> Result<()> {
        let started = Instant::now();
        if let Some(pictures) = &self.pictures
            && started >= self.next
            && renderer.start() >= 1.0
        {
            if let Err(TrySendError::Disconnected(_)) = pictures.try_send(renderer.film()?.mean()) {
                self.pictures = None;
            }
            self.next = Instant::now() + INTERVAL.max(started.elapsed() * SHARE);
        }
        Ok(())
    }

    /// Shows the last picture, and waits until tev has taken it or has gone away.
    pub fn finish(self, image: &Image) {
        if let Some(pictures) = self.pictures {
            // Where nobody takes it, tev has gone away, and that has been said.
            let _ = pictures.send(image.clone());
        }
        if let Some(showing) = self.showing {
            let _ = showing.join();
        }
    }
}

/// Shows pictures until there are no more of them. That tev has gone away is a warning.
fn show_all(mut client: TevClient, pictures: &Receiver<Image>, (name, address): (&str, &str), quiet: bool) {
    for image in pictures {
        if let Err(error) = send(&mut client, name, &image) {
            let takes_nothing = error.kind() == io::ErrorKind::WouldBlock;
            let why = if takes_nothing { String::from("it takes no more data") } else { error.to_string() };
            return warn(quiet, &format!("tev at {address} has gone away: {why}"));
        }
    }
}

fn warn(quiet: bool, what: &str) {
    if !quiet {
        say!("warning: {what}; the rendering goes on without it");
    }
}

/// Connects to tev, and has it open a black picture.
fn open(address: &str, image_name: &str, settings: &Settings) -> io::Result<TevClient> {
    let mut client = TevClient::wrap(connect(address)?);
    let (width, height, channel_names) = (settings.width, settings.height, &CHANNELS[..]);
    client.send(PacketCreateImage { image_name, grab_focus: true, width, height, channel_names })?;
    Ok(client)
}

/// A connection that gives up on a viewer that does not answer.
fn connect(address: &str) -> io::Result<TcpStream> {
    let mut failed = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                return Ok(stream);
            }
            Err(error) => failed = error,
        }
    }
    Err(failed)
}

/// Sends all pixels, some rows in each packet.
fn send(client: &mut TevClient, image_name: &str, image: &Image) -> io::Result<()> {
    let rows = (PACKET / (size_of::<[f32; 3]>() * image.width.max(1) as usize)).max(1);
    for (index, pixels) in image.pixels.chunks(rows * image.width.max(1) as usize).enumerate() {
        client.send(PacketUpdateImage {
            image_name,
            grab_focus: false,
            channel_names: &CHANNELS,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x: 0,
            y: (index * rows) as u32,
            width: image.width,
            height: (pixels.len() / image.width.max(1) as usize) as u32,
            data: bytemuck::cast_slice(pixels),
        })?;
    }
    Ok(())
}

/// `--tev`: a host with a port.
pub(super) fn parse(text: &str) -> Result<String, String> {
    let port = text.rsplit_once(':').filter(|(host, _)| !host.is_empty()).map(|(_, port)| port.parse::<u16>());
    match port {
        Some(Ok(1..)) => Ok(text.to_owned()),
        _ => Err(format!(
            "it must be HOST:PORT, such as localhost:{USUAL_PORT}, where tev listens unless it is told otherwise"
        )),
    }
}
