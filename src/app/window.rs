//! The window and its event loop: who is woken when, and what is drawn then.

mod meter;
mod paint;
mod pictures;
mod still;
mod truth;

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, EventLoopProxy};
use winit::window::{Fullscreen, Window, WindowId};

use super::action::{self, Browse, Export, Request, Shape, Still};
use super::egui_glue::{Egui, Place};
use super::hands::Hands;
use super::lab::{Lab, News};
use super::recovery::Recovery;
use super::surface::WindowSurface;
use super::viewport::{Step, Viewport};
use super::worker::{Event, Helm, Message, StillJob, Worker};
use super::{Action, NoDisplay, Session, about, crash};
use crate::files::KeptPrograms;
use crate::gpu::{AdapterChoice, Gpu};
use crate::ui::{Busy, Readout};

/// Shortest time between two frames of the panels; longer while a picture is being made, which needs the device too.
const FASTEST_PANELS: Duration = Duration::from_millis(16);
const FASTEST_PANELS_BESIDE_WORK: Duration = Duration::from_millis(33);
/// Time between two frames of the panels while something in them moves by itself.
const MOVING_PANELS: Duration = Duration::from_millis(50);
/// How often the device is asked whether it has finished a slice.
const POLL: Duration = Duration::from_millis(2);
/// A device that is lost again within this time is not opened a third time.
const HOPELESS: Duration = Duration::from_secs(5);

/// Opens the window and runs until it is closed.
pub(super) fn run(session: Session, adapter: AdapterChoice) -> anyhow::Result<()> {
    let event_loop = EventLoop::<Event>::with_user_event().build();
    let event_loop = event_loop.map_err(|error| NoDisplay(error.to_string()))?;
    crash::watch(&session.folders.state);
    let (recovery, left) = Recovery::open(&session.folders.state);
    let mut app = App {
        lab: Lab::default(),
        proxy: event_loop.create_proxy(),
        worker: Worker::new(event_loop.create_proxy()),
        session,
        adapter,
        recovery,
        live: None,
        lose_device_after: lose_device_after(),
        waiting: Vec::new(),
        is_working: true,
        metered: Instant::now(),
        is_metered: false,
        small: pictures::SmallPictures::default(),
        helm: None,
        failure: None,
    };
    if let Some(report) = crash::unseen(&app.session.folders.state) {
        app.session
            .ui
            .toasts
            .error(format!("The last run ended by a crash; what is known of it is in {}", report.display()));
    }
    left.damage.into_iter().for_each(|said| app.session.ui.toasts.error(said));
    app.session.offer_recovery(left.copies);
    event_loop.run_app(&mut app).context("the window's event loop failed")?;
    app.failure.map_or(Ok(()), Err)
}

/// The program with its window.
struct App {
    session: Session,
    adapter: AdapterChoice,
    recovery: Recovery,
    worker: Worker,
    lab: Lab,
    proxy: EventLoopProxy<Event>,
    /// What exists only while there is a window.
    live: Option<Live>,
    /// When the device is taken away, to try what then happens.
    lose_device_after: Option<Duration>,
    /// What wants the picture of the sky as it is now, once it is finished.
    waiting: Vec<Request>,
    /// Whether the picture of the sky as it is now is not finished yet.
    is_working: bool,
    /// When the light of the picture was measured last, and whether that was of the picture that is shown.
    metered: Instant,
    is_metered: bool,
    /// Pictures of presets that have none.
    small: pictures::SmallPictures,
    /// Steers the still that is being rendered.
    helm: Option<Arc<Helm>>,
    /// Why the program ends.
    failure: Option<anyhow::Error>,
}

/// Window, device, panels, picture.
struct Live {
    window: Arc<Window>,
    /// Gone only while the device is replaced: a window has one surface at a time.
    surface: Option<WindowSurface>,
    gpu: Gpu,
    programs: Option<KeptPrograms>,
    egui: Egui,
    viewport: Viewport,
    hands: Hands,
    title: String,
    /// When the panels were drawn last, and when they are due.
    drawn: Instant,
    due: Option<Instant>,
    /// When time and camera were moved last.
    ticked: Instant,
    occluded: bool,
    /// Whether the picture is another than the one that was compared with a snapshot last.
    is_new: bool,
    device_opened: Instant,
}

impl Live {
    fn open(
        event_loop: &ActiveEventLoop,
        proxy: EventLoopProxy<Event>,
        adapter: &AdapterChoice,
    ) -> anyhow::Result<Self> {
        let attributes = Window::default_attributes()
            .with_title("Nephoscope")
            .with_inner_size(winit::dpi::LogicalSize::new(1280.0, 720.0))
            .with_min_inner_size(winit::dpi::LogicalSize::new(320.0, 240.0))
            // Screen readers are told about the window before it shows.
            .with_visible(false);
        let window = Arc::new(event_loop.create_window(attributes).context("no window could be opened")?);
        let (surface, gpu) = WindowSurface::open(&window, adapter)?;
        let programs = KeptPrograms::begin(&gpu);
        let egui = Egui::new((event_loop, proxy), &window, &gpu, surface.format());
        let viewport = Viewport::new(&gpu)?;
        window.set_visible(true);
        let now = Instant::now();
        Ok(Self {
            window,
            surface: Some(surface),
            gpu,
            programs,
            egui,
            viewport,
            hands: Hands::default(),
            title: String::new(),
            drawn: now,
            due: Some(now),
            ticked: now,
            occluded: false,
            is_new: true,
            device_opened: now,
        })
    }

    /// Whether there is anything to draw on.
    fn is_drawable(&self) -> bool {
        let size = self.window.inner_size();
        size.width > 1 && size.height > 1 && !self.occluded && self.window.is_minimized() != Some(true)
    }

    /// Wants the panels drawn in a while, or sooner if they are due sooner.
    fn draw_within(&mut self, delay: Duration) {
        if let Some(due) = Instant::now().checked_add(delay) {
            self.due = Some(self.due.map_or(due, |before| before.min(due)));
        }
    }
}

impl ApplicationHandler<Event> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.live.is_some() {
            return;
        }
        match Live::open(event_loop, self.proxy.clone(), &self.adapter) {
            Ok(live) => {
                self.session.apply_preferences(live.egui.context());
                crash::set_system(about::this(Some(&live.gpu)));
                self.live = Some(live);
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if event == WindowEvent::Focused(true) {
            // Whoever comes back may have saved a preset elsewhere.
            self.session.notice_presets();
        }
        let Some(live) = &mut self.live else { return };
        if truth::is_input(&event) {
            live.viewport.truths.touch(Instant::now());
        }
        match &event {
            WindowEvent::CloseRequested => {
                self.perform(event_loop, Action::Ask(Request::Quit));
            }
            WindowEvent::RedrawRequested => self.draw(event_loop),
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                if let Some(surface) = &mut live.surface {
                    surface.follow_window(&live.gpu);
                }
                live.egui.on_window_event(&live.window, &event);
                live.draw_within(Duration::ZERO);
            }
            WindowEvent::Occluded(occluded) => {
                live.occluded = *occluded;
                live.draw_within(Duration::ZERO);
            }
            WindowEvent::DroppedFile(path) => {
                let request = self.session.drop_file(path);
                live.draw_within(Duration::ZERO);
                request.into_iter().for_each(|request| self.fulfil(event_loop, request));
            }
            _ => {
                let typing = live.egui.context().egui_wants_keyboard_input();
                if live.hands.takes(&live.window, &event, typing) || live.egui.on_window_event(&live.window, &event) {
                    live.draw_within(Duration::ZERO);
                }
            }
        }
    }

    fn device_event(&mut self, _: &ActiveEventLoop, _: DeviceId, event: DeviceEvent) {
        if let (Some(live), DeviceEvent::MouseMotion { delta }) = (&mut self.live, event) {
            live.hands.move_mouse(delta);
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        match event {
            Event::Accessibility(event) => self.accessibility(event),
            Event::Worker(message) => self.report(event_loop, message),
            Event::Compared(compared) => self.take_comparison(*compared),
            Event::Lab(news) => self.take_measured(*news),
        }
        if let Some(live) = &mut self.live {
            live.draw_within(Duration::ZERO);
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.tick();
        let wake = self.work();
        event_loop.set_control_flow(match wake {
            Some(wake) => ControlFlow::WaitUntil(wake),
            None => ControlFlow::Wait,
        });
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.lab.leave();
        if let Some(mut live) = self.live.take()
            && let Some(programs) = &mut live.programs
        {
            programs.keep(&live.gpu);
        }
    }
}

impl App {
    fn fail(&mut self, event_loop: &ActiveEventLoop, error: anyhow::Error) {
        // The document must not be lost with the window.
        self.recovery.keep(&self.session.document);
        self.failure = Some(error);
        event_loop.exit();
    }

    /// Lets time run and the camera fly for as long as has passed.
    fn tick(&mut self) {
        let Some(live) = &mut self.live else { return };
        let passed = live.ticked.elapsed().as_secs_f64().min(0.5);
        live.ticked = Instant::now();
        self.session.document.advance_clock(passed);
        if let Some(action) = live.hands.tick(&self.session.document, passed) {
            self.session.document.apply(&action);
            live.draw_within(MOVING_PANELS);
        }
        let hud = live.hands.hud();
        if hud != self.session.ui.viewport.hud {
            self.session.ui.viewport.hud = hud;
            live.draw_within(Duration::ZERO);
        }
        self.recovery.tend(&self.session.document);
    }

    /// Sends the next slice of the picture, asks for the panels when they are due, and says when to wake up.
    fn work(&mut self) -> Option<Instant> {
        self.paint();
        let live = self.live.as_mut()?;
        let now = Instant::now();
        let mut wake = self.recovery.due_in(&self.session.document).map(|due| now + due);
        if !live.is_drawable() {
            return wake;
        }
        let (mut is_idle, mut is_new) = (false, false);
        let size = self.session.ui.viewport.size_px(live.egui.context().pixels_per_point());
        let mut fastest = FASTEST_PANELS;
        if self.session.ui.viewport.rect.width() >= 1.0 && self.session.ui.viewport.rect.height() >= 1.0 {
            self.session.ui.lab.view.governor = live.viewport.govern(&self.session.ui.lab);
            let region = self.session.ui.viewport.region;
            match live.viewport.step(&self.session.document, (size, region), self.session.ui.forced()) {
                Ok(Step::Idle) => is_idle = true,
                Ok(Step::Busy) => {
                    fastest = FASTEST_PANELS_BESIDE_WORK;
                    wake = sooner(wake, now + POLL);
                }
                Ok(Step::Finished) => {
                    if let Some(broken) = live.viewport.take_broken() {
                        self.session.ui.toasts.error(broken);
                    }
                    live.is_new = true;
                    is_new = true;
                    live.draw_within(Duration::ZERO);
                    wake = Some(now);
                }
                Err(error) => {
                    self.session.ui.toasts.error(error);
                    live.draw_within(Duration::ZERO);
                }
            }
        }
        if self.session.document.is_playing() || live.hands.are_busy() {
            wake = sooner(wake, now + 5 * POLL);
        }
        self.is_working = !is_idle;
        // A picture that never comes to rest is taken as it is.
        if is_idle || self.session.document.is_playing() {
            self.inspect();
            self.take_pictures();
        }
        if let Some(again) = self.meter(is_new) {
            wake = sooner(wake, again);
        }
        let refined = self.refine(is_idle);
        let later = self.make_small_pictures(is_idle && !refined.has_worked && self.helm.is_none());
        if refined.has_worked {
            fastest = FASTEST_PANELS_BESIDE_WORK;
        }
        for turn in refined.wake.into_iter().chain(later) {
            wake = sooner(wake, turn);
        }
        let live = self.live.as_mut()?;
        let now = Instant::now();
        if let Some(due) = live.due {
            let due = due.max(live.drawn + fastest);
            if due <= now {
                live.window.request_redraw();
            }
            wake = sooner(wake, due.max(now + POLL));
        }
        wake
    }

    /// Draws the panels and the last finished picture, and does what the user wants.
    fn draw(&mut self, event_loop: &ActiveEventLoop) {
        let Some(live) = &mut self.live else { return };
        if !live.is_drawable() {
            return;
        }
        let begun = Instant::now();
        live.due = None;
        live.show_pictures(&mut self.session);
        let Some(surface) = &mut live.surface else { return };
        surface.follow_window(&live.gpu);
        let viewport = &mut self.session.ui.viewport;
        viewport.picture = live.egui.set_picture(&live.gpu, Place::Frame, live.viewport.renderer().display());
        let compiling = live.viewport.is_compiling();
        viewport.status = if compiling { "Compiling shaders…" } else { "Preparing the sky…" }.to_owned();
        let readout = if self.session.ui.show_overlay { live.viewport.readout() } else { Readout::default() };
        let mut requests = Vec::new();
        let session = &mut self.session;
        let again = live.egui.frame((&live.window, event_loop), &live.gpu, surface, &mut |ui| {
            requests.extend(session.frame(ui, &readout));
        });
        // Before the next picture, which may be that of a region.
        live.keep_backdrop(&mut self.session);
        if again < Duration::MAX {
            live.draw_within(again.max(MOVING_PANELS));
        }
        for gesture in std::mem::take(&mut self.session.ui.viewport.gestures) {
            let size_pt = self.session.ui.viewport.size_px(1.0);
            if let Some(action) = live.hands.gesture(&live.window, (&self.session.document, size_pt), gesture) {
                self.session.document.apply(&action);
            }
        }
        live.drawn = Instant::now();
        live.viewport.statistics.add_panel((live.drawn - begun).as_secs_f64() * 1000.0);
        let title = self.session.title();
        if title != live.title {
            live.window.set_title(&title);
            live.title = title;
        }
        for request in requests {
            self.fulfil(event_loop, request);
        }
        self.look_after_device(event_loop);
    }

    fn perform(&mut self, event_loop: &ActiveEventLoop, action: Action) {
        if let Some(request) = self.session.perform(action) {
            self.fulfil(event_loop, request);
        }
        if let Some(live) = &mut self.live {
            live.draw_within(Duration::ZERO);
        }
    }

    /// Does what only the window and its threads can do.
    fn fulfil(&mut self, event_loop: &ActiveEventLoop, request: Request) {
        match request {
            Request::Quit => {
                // What a crash left stays until somebody says what becomes of it.
                if !self.session.has_undecided_recovery() {
                    self.recovery.clear();
                }
                event_loop.exit();
            }
            Request::Browse(purpose) => self.browse(purpose),
            Request::Screenshot => self.screenshot(),
            Request::Snapshot | Request::KeepPicture(_) => self.wait_for_picture(request),
            Request::CopyPicture => self.copy_picture(),
            Request::CopySystem => {
                if let Some(live) = &self.live {
                    live.egui.context().copy_text(about::this(Some(&live.gpu)));
                    self.session.ui.toasts.info("What this machine is lies in the clipboard");
                }
            }
            Request::Export(export) => self.render_still(export),
            Request::Steer(steering) => self.steer_still(steering),
            Request::Lab(wish) => self.measure(wish),
            Request::Recover(Some(_)) => self.recovery.keep(&self.session.document),
            Request::Recover(None) => self.recovery.clear(),
            Request::ToggleFullScreen => {
                let Some(live) = &self.live else { return };
                let full = live.window.fullscreen().is_none().then_some(Fullscreen::Borderless(None));
                live.window.set_fullscreen(full);
            }
            Request::New
            | Request::Open(_)
            | Request::Save
            | Request::SaveAs(_)
            | Request::Answer(_)
            | Request::TakeOver { .. }
            | Request::Morph(_)
            | Request::Paste { .. } => {}
        }
    }

    /// Does what the lab's panel wants.
    fn measure(&mut self, wish: action::Lab) {
        let Some(live) = &self.live else { return };
        let preset = self.session.document.preset();
        if let Some(view) = self.lab.fulfil(wish, (&live.gpu, preset), &self.proxy) {
            self.session.ui.lab.view = view;
        }
    }

    /// Takes in what was measured.
    fn take_measured(&mut self, news: News) {
        if let Some(view) = self.lab.take(news) {
            self.session.ui.lab.view = view;
        }
    }

    fn browse(&mut self, purpose: Browse) {
        let path = self.session.document.path().and_then(|path| path.parent());
        let start = path.unwrap_or(&self.session.folders.presets).to_owned();
        if self.helm.is_none() {
            let text = "Waiting for the file dialog…".to_owned();
            self.session.ui.busy = Some(Busy { text, progress: None, steering: None, end: "" });
        }
        self.worker.browse(purpose, &start);
    }

    fn screenshot(&mut self) {
        let Some(live) = &self.live else { return };
        if live.viewport.renderer().display().is_none() {
            self.session.ui.toasts.error("There is no picture to save yet; wait for the first one");
            return;
        }
        match live.shown_rgba8(&self.session) {
            Ok(image) => {
                let document = &self.session.document;
                let still = StillJob {
                    gpu: live.gpu.clone(),
                    preset: document.preset().clone(),
                    quality: document.quality().clone(),
                    time_secs: document.time_secs(),
                    export: Export {
                        still: Still::Png,
                        size: image.0,
                        shape: Shape::Camera,
                        level: None,
                        frames: None,
                        brightest: None,
                        region: None,
                        path: self.session.folders.pictures.clone(),
                    },
                };
                self.worker.screenshot(still, image);
            }
            Err(error) => self.session.ui.toasts.error(error),
        }
    }

    /// Takes in what a thread found or did.
    fn report(&mut self, event_loop: &ActiveEventLoop, message: Message) {
        let session = &mut self.session;
        if !matches!(message, Message::Progress(..) | Message::Still(_) | Message::SmallPicture(..))
            && self.helm.is_none()
        {
            session.ui.busy = None;
        }
        match message {
            Message::Progress(share, begun) => self.hear_of_still(share, begun),
            Message::Still(result) => self.finish_still(result),
            Message::SmallPicture(preset, picture) => self.take_small_picture(&preset, picture),
            Message::Picked(purpose, path) => session.picked(&purpose, &path),
            Message::NotPicked => {}
            Message::NoFileDialog => session.ui.toasts.error(
                "This system offers no file dialog (neither a desktop portal nor zenity). Type the path instead.",
            ),
            Message::Written(path) => session.ui.toasts.info(format!("Saved {}", path.display())),
            Message::Failed(error) => session.ui.toasts.error(error),
        }
        self.look_after_device(event_loop);
    }

    fn accessibility(&mut self, event: egui_winit::accesskit_winit::Event) {
        use egui_winit::accesskit_winit::WindowEvent as Wish;
        let Some(live) = &mut self.live else { return };
        match event.window_event {
            Wish::InitialTreeRequested => live.egui.context().enable_accesskit(),
            Wish::ActionRequested(request) => live.egui.on_accessibility_request(request),
            Wish::AccessibilityDeactivated => live.egui.context().disable_accesskit(),
        }
    }

    /// Reports errors of the device that nobody waited for; a lost device is replaced, and all it held made anew.
    fn look_after_device(&mut self, event_loop: &ActiveEventLoop) {
        let Some(live) = &mut self.live else { return };
        if self.lose_device_after.is_some_and(|after| live.device_opened.elapsed() >= after) {
            self.lose_device_after = None;
            live.gpu.device.destroy();
        }
        // Another thread may have taken the error of a lost device.
        let taken = live.gpu.take_uncaught_error();
        let Some(error) = taken.or_else(|| live.gpu.loss()) else { return };
        let lost = live.gpu.is_lost();
        self.session.ui.toasts.error(error);
        live.draw_within(Duration::ZERO);
        if !lost {
            return;
        }
        self.recovery.keep(&self.session.document);
        if live.device_opened.elapsed() < HOPELESS {
            self.fail(event_loop, anyhow::anyhow!("the graphics device was lost twice; unsaved work was kept"));
            return;
        }
        match live.rebuild(&self.adapter) {
            Ok(()) => self.session.reload_textures(live.egui.context()),
            Err(error) => self.fail(event_loop, error),
        }
    }
}

/// Seconds after which `NEPHOSCOPE_LOSE_DEVICE_AFTER` wants the device lost.
fn lose_device_after() -> Option<Duration> {
    let seconds: f64 = std::env::var("NEPHOSCOPE_LOSE_DEVICE_AFTER").ok()?.parse().ok()?;
    Duration::try_from_secs_f64(seconds).ok()
}

/// The earlier of two times to wake up.
fn sooner(wake: Option<Instant>, other: Instant) -> Option<Instant> {
    Some(wake.map_or(other, |wake| wake.min(other)))
}

impl Live {
    /// Opens the device again and makes everything on it anew; the document is untouched.
    fn rebuild(&mut self, adapter: &AdapterChoice) -> anyhow::Result<()> {
        self.surface = None;
        let (surface, gpu) = WindowSurface::open(&self.window, adapter)?;
        self.programs = KeptPrograms::begin(&gpu);
        self.egui.rebuild(&gpu, surface.format());
        self.viewport = Viewport::new(&gpu)?;
        self.surface = Some(surface);
        self.gpu = gpu;
        self.device_opened = Instant::now();
        Ok(())
    }
}
