//! The window: its events, its frames, and what becomes of it when the device or its pixels go away.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use egui_winit::winit;
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Window, WindowId};

use super::display::{Scale, srgb_pixels};
use super::inspect::Inspection;
use super::interface;
use super::news::{Doing, Facts, Picture};
use super::screenshot;
use super::state::State;
use super::wanted::{ChooseBackend, Wanted};
use super::worker::Worker;
use super::{display::Display, panel};
use crate::error::{Error, Result};
use crate::gpu::window::{NativeWindow, Presenter, Shown, instance};
use crate::gpu::{Instance, draw_triangles};

/// The window's size at the start, in points: the panel, and a picture beside it.
const SIZE: [f64; 2] = [1180.0, 800.0];
/// How often it is looked whether the user has interrupted the program.
const LISTEN: Duration = Duration::from_millis(200);
/// How often in a row the window's device may be lost, without a frame in between.
const MOST_LOSSES: u32 = 5;
/// The largest side of a picture on the device: every Vulkan device has textures of that size.
const MOST_SIDE: u32 = 4096;

/// What the viewer begins with.
pub struct Start {
    /// What is wanted first.
    pub wanted: Wanted,
    /// Finds the backend of a name.
    pub choose_backend: ChooseBackend,
    /// Whether every Vulkan call is checked.
    pub validate: bool,
    /// Set when the user interrupts the program.
    pub interrupted: Arc<AtomicBool>,
    /// Is told what happens, line by line.
    pub tell: Box<dyn Fn(&str)>,
}

/// Something to look at has come.
#[derive(Debug)]
struct Wake;

/// Opens the window, and returns when it is closed: the messages of the validation layer. Fails where there is no display, or no device that
/// shows pictures on it.
pub fn open(start: Start) -> Result<Vec<String>> {
    let began = Instant::now();
    let no_display = |error: winit::error::EventLoopError| {
        let why = match &error {
            winit::error::EventLoopError::Os(_) if !has_display() => {
                String::from("there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set)")
            }
            // Before its last part are places in the library's code.
            other => other.to_string().rsplit(": ").next().unwrap_or_default().to_owned(),
        };
        Error::Device(format!("no window can be opened: {why}; `lumbre render` needs none"))
    };
    draw_triangles();
    // Before anything else reads the environment on another thread.
    let of_worker = Instance::new(start.validate)?;
    let events = EventLoop::<Wake>::with_user_event().build().map_err(no_display)?;
    let proxy = events.create_proxy();
    let wake = events.create_proxy();
    let worker = Worker::start(of_worker, start.wanted.clone(), start.choose_backend, move || {
        let _ = wake.send_event(Wake); // the window may be closed already
    })?;
    let mut viewer = Viewer {
        state: State::new(start.wanted.clone(), worker.news()),
        context: context(&proxy),
        proxy,
        start,
        began,
        worker: Some(worker),
        there: None,
        on_device: None,
        losses: 0,
        next_frame: None,
        told: Told::default(),
        frames: None,
        failed: None,
        messages: Vec::new(),
    };
    let ran = events.run_app(&mut viewer).map_err(no_display);
    viewer.close();
    ran?;
    viewer.failed.map_or(Ok(viewer.messages), Err)
}

/// Whether the environment names a display.
fn has_display() -> bool {
    ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn context(proxy: &EventLoopProxy<Wake>) -> egui::Context {
    let context = egui::Context::default();
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        style.visuals.panel_fill = egui::Color32::from_rgb(27, 28, 31);
        style.visuals.override_text_color = Some(egui::Color32::from_rgb(214, 214, 214));
        style.spacing.item_spacing.y = 5.0;
        // Labels are no text to edit: dragging over them is no selection.
        style.interaction.selectable_labels = false;
    });
    let proxy = proxy.clone();
    context.set_request_repaint_callback(move |info| {
        if info.delay == Duration::ZERO {
            let _ = proxy.send_event(Wake);
        }
    });
    context
}

fn input(context: &egui::Context, window: &Window) -> egui_winit::State {
    let scale = Some(window.scale_factor() as f32);
    let side = Some(MOST_SIDE as usize);
    egui_winit::State::new(context.clone(), egui::ViewportId::ROOT, window, scale, None, side)
}

/// What there is once the window is open.
struct There {
    // In the order in which they go.
    presenter: Presenter,
    input: egui_winit::State,
    instance: Instance,
    window: Arc<Window>,
}

/// What the texture of the picture was made of.
#[derive(Clone)]
struct OnDevice {
    picture: Arc<Picture>,
    display: Display,
    is_smooth: bool,
}

/// What has been told already.
#[derive(Default)]
struct Told {
    picture_of: Option<(u64, String)>,
    losses: u32,
    trouble: Option<String>,
    done: Option<(u64, u64)>,
    notice: Option<String>,
    pixel: Option<Inspection>,
    title: String,
}

struct Viewer {
    start: Start,
    began: Instant,
    state: State,
    context: egui::Context,
    proxy: EventLoopProxy<Wake>,
    worker: Option<Worker>,
    there: Option<There>,
    on_device: Option<OnDevice>,
    losses: u32,
    /// When egui wants to be drawn again.
    next_frame: Option<Instant>,
    told: Told,
    /// How long the first frame took, when the device compiles what draws, and the longest of all others.
    frames: Option<[Duration; 2]>,
    failed: Option<Error>,
    messages: Vec<String>,
}

impl ApplicationHandler<Wake> for Viewer {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.there.is_none()
            && let Err(error) = self.open_window(events)
        {
            self.fail(events, error);
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, _: Wake) {
        if let Some(error) = self.worker.as_ref().and_then(Worker::take_fatal) {
            return self.fail(events, error);
        }
        self.request_frame();
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(there) = &mut self.there else { return };
        let response = there.input.on_window_event(&there.window, &event);
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::DroppedFile(path) => {
                self.drop_file(path);
                self.request_frame();
            }
            WindowEvent::RedrawRequested => {
                let started = Instant::now();
                if let Err(error) = self.frame() {
                    self.recover(events, error);
                }
                let took = started.elapsed();
                match &mut self.frames {
                    None => self.frames = Some([took, Duration::ZERO]),
                    Some([_, longest]) => *longest = took.max(*longest),
                }
                if self.state.quits {
                    events.exit();
                }
            }
            _ if response.repaint => self.request_frame(),
            _ => {}
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if self.start.interrupted.load(Ordering::Relaxed) {
            events.exit();
        }
        let now = Instant::now();
        if self.next_frame.is_some_and(|at| at <= now) {
            self.next_frame = None;
            self.request_frame();
        }
        let listen = now + LISTEN;
        events.set_control_flow(ControlFlow::WaitUntil(self.next_frame.map_or(listen, |at| at.min(listen))));
    }
}

impl Viewer {
    fn open_window(&mut self, events: &ActiveEventLoop) -> Result<()> {
        let failed = |error: winit::error::OsError| Error::Device(format!("no window can be opened: {error}"));
        let attributes = Window::default_attributes()
            .with_title(self.title())
            .with_inner_size(LogicalSize::new(SIZE[0], SIZE[1]))
            .with_min_inner_size(LogicalSize::new(320.0, 240.0));
        let window = Arc::new(events.create_window(attributes).map_err(failed)?);
        let instance = instance(self.start.validate, &window)?;
        let presenter = self.present(&instance, &window)?;
        let input = input(&self.context, &window);
        let size = window.inner_size();
        (self.start.tell)(&format!("window {}x{} on {}", size.width, size.height, presenter.survey().name));
        window.request_redraw();
        self.there = Some(There { presenter, input, instance, window });
        Ok(())
    }

    fn present(&self, instance: &Instance, window: &Arc<Window>) -> Result<Presenter> {
        let native: Arc<dyn NativeWindow> = window.clone();
        Presenter::new(instance, self.start.wanted.device.as_deref(), &native)
    }

    fn title(&self) -> String {
        let name = self.state.wanted.scene.file_name().unwrap_or_default().to_string_lossy().into_owned();
        format!("{name} - lumbre")
    }

    fn request_frame(&self) {
        if let Some(there) = &self.there {
            there.window.request_redraw();
        }
    }

    fn drop_file(&mut self, path: PathBuf) {
        self.state.open(path);
        self.send();
    }

    /// Tells the worker what is wanted, where that has changed.
    fn send(&mut self) {
        if std::mem::take(&mut self.state.is_changed)
            && let Some(worker) = &self.worker
        {
            worker.want(self.state.wanted.clone());
        }
    }

    /// Draws the window as everything stands.
    fn frame(&mut self) -> Result<()> {
        if let Some(worker) = &self.worker {
            self.state.hear(worker.news());
        }
        self.tell_news();
        let title = self.title();
        let Some(there) = &mut self.there else { return Ok(()) };
        if title != self.told.title {
            there.window.set_title(&title);
            self.told.title = title;
        }
        let input = there.input.take_egui_input(&there.window);
        let state = &mut self.state;
        let output = self.context.run(input, |context| {
            state.keys(context);
            egui::SidePanel::right("panel")
                .exact_width(panel::WIDTH)
                .resizable(false)
                .show(context, |ui| panel::show(ui, state));
            let back = egui::Frame::NONE.fill(egui::Color32::from_rgb(14, 14, 15));
            egui::CentralPanel::default().frame(back).show(context, |ui| state.show_picture(ui));
        });
        if std::mem::take(&mut self.state.shoots) {
            self.shoot();
        }
        if self.state.notice.is_some() && self.state.notice != self.told.notice {
            self.told.notice.clone_from(&self.state.notice);
            self.state.notice.iter().for_each(|notice| (self.start.tell)(notice));
            self.next_frame = Some(Instant::now()); // it is in the panel from the next frame on
        }
        if let Some(found) = self.state.inspection.clone().filter(|found| self.told.pixel.as_ref() != Some(found)) {
            let ([x, y], [r, g, b]) = (found.pixel, found.value);
            (self.start.tell)(&format!("pixel {x},{y}: {r} {g} {b}"));
            self.told.pixel = Some(found);
        }
        self.send();
        self.show(output)
    }

    /// Shows what egui has drawn.
    fn show(&mut self, output: egui::FullOutput) -> Result<()> {
        let Some(there) = &mut self.there else { return Ok(()) };
        if let Some(viewport) = output.viewport_output.get(&egui::ViewportId::ROOT) {
            let next = Instant::now().checked_add(viewport.repaint_delay);
            self.next_frame = [self.next_frame, next].into_iter().flatten().min();
        }
        there.input.handle_platform_output(&there.window, output.platform_output.clone());
        interface::set_textures(&mut there.presenter, &output.textures_delta)?;
        let pixels_per_point = output.pixels_per_point;
        let width = self.state.place.width() * pixels_per_point;
        if let Some(picture) = &self.state.news.picture {
            // Pixels that are shown larger stay squares.
            let is_smooth = width < picture.image.width as f32 * 1.5;
            let wanted = OnDevice { picture: picture.clone(), display: self.state.display, is_smooth };
            let is_there = self.on_device.as_ref().is_some_and(|own| {
                Arc::ptr_eq(&own.picture, &wanted.picture)
                    && own.display == wanted.display
                    && own.is_smooth == is_smooth
            });
            if !is_there {
                let scale = picture.layer.scale();
                let (size, pixels) = pixels(picture, &wanted.display, scale);
                interface::set_picture(&mut there.presenter, size, &pixels, is_smooth)?;
                self.on_device = Some(wanted);
            }
        }
        let meshes = interface::meshes(&self.context, &output);
        let size = there.window.inner_size();
        let shown = there.presenter.show([size.width, size.height], &meshes)?;
        interface::free_textures(&mut there.presenter, &output.textures_delta)?;
        match shown {
            Shown::Yes => self.losses = 0,
            Shown::Again => there.window.request_redraw(),
            Shown::Minimised => self.next_frame = None,
        }
        Ok(())
    }

    fn shoot(&mut self) {
        let (Some(picture), Some(facts)) = (&self.state.news.picture, self.state.facts()) else { return };
        self.state.notice = Some(match shoot(picture, &self.state.display, &facts) {
            Ok(text) => text,
            Err(error) => error.to_string(),
        });
    }

    /// Says what has happened since the last time.
    fn tell_news(&mut self) {
        let (news, told, tell) = (&self.state.news, &mut self.told, &self.start.tell);
        if news.losses > told.losses {
            told.losses = news.losses;
            tell(&format!("losses of the device so far: {}", news.losses));
        }
        if news.trouble != told.trouble {
            told.trouble.clone_from(&news.trouble);
            news.trouble.iter().for_each(|trouble| tell(trouble));
        }
        let (Some(picture), Some(facts)) = (&news.picture, &news.facts) else { return };
        let of = (picture.scene_number, picture.made_by.clone());
        if facts.scene_number == picture.scene_number && told.picture_of.as_ref() != Some(&of) {
            tell(&format!(
                "picture of {} after {:.2} s: {}x{} by {}, {:.1} spp",
                facts.scene.display(),
                self.began.elapsed().as_secs_f64(),
                picture.image.width,
                picture.image.height,
                of.1,
                picture.spp
            ));
            told.picture_of = Some(of);
        }
        let done = Some((picture.scene_number, picture.camera_number)).filter(|_| news.doing == Doing::Resting);
        if !self.state.wanted.is_paused && done.is_some() && told.done != done {
            let place = if self.state.wanted.camera.is_none() { "the scene's camera" } else { "elsewhere" };
            tell(&format!("done: {:.0} spp from {place}", picture.spp));
            told.done = done;
        }
    }

    /// Opens the window's device again, where it was lost.
    fn recover(&mut self, events: &ActiveEventLoop, error: Error) {
        self.losses += 1;
        let Some(there) = self.there.take().filter(|_| self.losses <= MOST_LOSSES) else {
            return self.fail(events, error);
        };
        (self.start.tell)(&format!("{error}; the window's device is opened again"));
        self.messages.extend(there.presenter.take_validation_messages());
        let There { presenter, instance, window, .. } = there;
        drop(presenter); // a window has one surface at a time
        // All textures went with the device: a new egui asks for its own again.
        self.on_device = None;
        self.context = context(&self.proxy);
        match self.present(&instance, &window) {
            Ok(presenter) => {
                let input = input(&self.context, &window);
                window.request_redraw();
                self.there = Some(There { presenter, input, instance, window });
            }
            Err(error) => self.fail(events, error),
        }
    }

    fn fail(&mut self, events: &ActiveEventLoop, error: Error) {
        self.failed = Some(error);
        events.exit();
    }

    /// Ends the worker and closes the window.
    fn close(&mut self) {
        if let Some(there) = self.there.take() {
            there.window.set_visible(false);
            self.messages.extend(there.presenter.take_validation_messages());
        }
        if let Some(worker) = self.worker.take() {
            self.messages.extend(worker.end());
        }
        let [first, longest] = self.frames.unwrap_or_default().map(|took| took.as_secs_f64() * 1e3);
        (self.start.tell)(&format!(
            "closed; the first frame took {first:.0} ms, the longest other one {longest:.0} ms"
        ));
    }
}

fn shoot(picture: &Picture, display: &Display, facts: &Facts) -> Result<String> {
    let [png, exr] = screenshot::write(picture, display, facts)?;
    Ok(format!("wrote {}, {}", png.display(), exr.display()))
}

/// The pixels of the picture as the screen is to show them: all of them, or of a picture that is larger than textures are every second, third, ...
fn pixels(picture: &Picture, display: &Display, scale: Scale) -> ([u32; 2], Vec<[u8; 4]>) {
    let image = display.tone(&picture.image, scale);
    let all = srgb_pixels(&image);
    let step = image.width.max(image.height).div_ceil(MOST_SIDE).max(1);
    if step == 1 {
        return ([image.width, image.height], all);
    }
    let some = |side: u32| (0..side).step_by(step as usize);
    let at = |x: u32, y: u32| all[y as usize * image.width as usize + x as usize];
    let pixels = some(image.height).flat_map(|y| some(image.width).map(move |x| at(x, y))).collect();
    ([image.width.div_ceil(step), image.height.div_ceil(step)], pixels)
}
