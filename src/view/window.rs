//! The window: its events, its frames, and what becomes of it when the device or its pixels go away.

mod display_server;
mod picture_texture;
mod telling;

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

use super::interface;
use super::news::{Facts, Picture};
use super::screenshot;
use super::state::State;
use super::wanted::Wanted;
use super::worker::Worker;
use super::{display::Display, panel};
use crate::error::{Error, Result};
use crate::gpu::window::{NativeWindow, Presenter, Shown, instance};
use crate::gpu::{Instance, draw_triangles};
use picture_texture::{MOST_SIDE, PictureTexture};
use telling::Telling;

/// The window's size at the start, in points: the panel, and a picture beside it.
const SIZE: [f64; 2] = [1180.0, 800.0];
/// How often it is looked whether the user has interrupted the program.
const LISTEN: Duration = Duration::from_millis(200);
/// How often in a row the window's device may be lost, without a frame in between.
const MOST_LOSSES: u32 = 5;
/// What the viewer begins with.
pub struct Start {
    /// What is wanted first.
    pub wanted: Wanted,
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
    let Start { wanted, validate, interrupted, tell } = start;
    draw_triangles();
    // Before anything else reads the environment on another thread.
    let of_worker = Instance::new(validate)?;
    let events = EventLoop::<Wake>::with_user_event().build().map_err(display_server::refusal)?;
    let proxy = events.create_proxy();
    let wake = events.create_proxy();
    let worker = Worker::start(of_worker, wanted.clone(), move || {
        let _ = wake.send_event(Wake); // the window may be closed already
    })?;
    let mut viewer = Viewer {
        state: State::new(wanted, worker.news()),
        context: context(&proxy),
        proxy,
        validate,
        interrupted,
        worker: Some(worker),
        there: None,
        texture: PictureTexture::default(),
        losses: 0,
        next_frame: None,
        telling: Telling::new(tell, began),
        shown_title: String::new(),
        frames: None,
        failed: None,
        messages: Vec::new(),
    };
    let ran = display_server::survive(|| events.run_app(&mut viewer));
    if ran.is_err() {
        // Nothing of a window can be closed that is not there any more.
        std::mem::forget(viewer.there.take());
    }
    viewer.close();
    ran?;
    viewer.failed.map_or(Ok(viewer.messages), Err)
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

struct Viewer {
    validate: bool,
    interrupted: Arc<AtomicBool>,
    state: State,
    context: egui::Context,
    proxy: EventLoopProxy<Wake>,
    worker: Option<Worker>,
    there: Option<There>,
    texture: PictureTexture,
    losses: u32,
    /// When egui wants to be drawn again.
    next_frame: Option<Instant>,
    telling: Telling,
    shown_title: String,
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
        if self.interrupted.load(Ordering::Relaxed) {
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
        let instance = instance(self.validate, &window)?;
        let presenter = self.present(&instance, &window)?;
        let input = input(&self.context, &window);
        let size = window.inner_size();
        self.telling.tell(&format!("window {}x{} on {}", size.width, size.height, presenter.survey().name));
        window.request_redraw();
        self.there = Some(There { presenter, input, instance, window });
        Ok(())
    }

    fn present(&self, instance: &Instance, window: &Arc<Window>) -> Result<Presenter> {
        let native: Arc<dyn NativeWindow> = window.clone();
        Presenter::new(instance, self.state.wanted.device.as_deref(), &native)
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
        self.telling.tell_news(&self.state);
        let title = self.title();
        let Some(there) = &mut self.there else { return Ok(()) };
        if title != self.shown_title {
            there.window.set_title(&title);
            self.shown_title = title;
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
        if self.telling.tell_actions(&self.state) {
            self.next_frame = Some(Instant::now()); // it is in the panel from the next frame on
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
            self.texture.bring(&mut there.presenter, picture, self.state.display, is_smooth)?;
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

    /// Opens the window's device again, where it was lost.
    fn recover(&mut self, events: &ActiveEventLoop, error: Error) {
        self.losses += 1;
        let Some(there) = self.there.take().filter(|_| self.losses <= MOST_LOSSES) else {
            return self.fail(events, error);
        };
        self.telling.tell(&format!("{error}; the window's device is opened again"));
        self.messages.extend(there.presenter.take_validation_messages());
        let There { presenter, instance, window, .. } = there;
        drop(presenter); // a window has one surface at a time
        // All textures went with the device: a new egui asks for its own again.
        self.texture.forget();
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
        self.telling
            .tell(&format!("closed; the first frame took {first:.0} ms, the longest other one {longest:.0} ms"));
    }
}

fn shoot(picture: &Picture, display: &Display, facts: &Facts) -> Result<String> {
    let [png, exr] = screenshot::write(picture, display, facts)?;
    Ok(format!("wrote {}, {}", png.display(), exr.display()))
}
