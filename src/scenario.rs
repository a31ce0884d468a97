//! Scenarios, and the sequences of images that they ask for.

use std::path::{Path, PathBuf};

use perilune_engine::dataset::Existing;
use perilune_engine::ephemeris::{Epoch, known_file};
use perilune_engine::pipeline::{self, Options, Prepared, Progress, capture};
use perilune_engine::render::{Image, Imaging, View};
use perilune_engine::scenario::{self, SearchPath};

use crate::{Adapter, Error, RunReport, Scene, Session};

/// What a RON file says of a sequence of images, checked: every key is known, every value in its range, every file found.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario(scenario::Scenario);

impl Scenario {
    /// Reads a scenario: a path, a name in `scenarios/`, or the name of a shipped one. Files that it names are looked for
    /// beside it, then in the folder `SIM_DATA`.
    ///
    /// # Errors
    /// [`ErrorKind::Scenario`](crate::ErrorKind::Scenario), with every [problem](Error::problems) of the text.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_with_data(path, &[])
    }

    /// Reads a scenario as [`load`](Self::load) does, with folders in which files are looked for before `SIM_DATA`.
    ///
    /// # Errors
    /// [`ErrorKind::Scenario`](crate::ErrorKind::Scenario), with every [problem](Error::problems) of the text.
    pub fn load_with_data(path: impl AsRef<Path>, data: &[PathBuf]) -> Result<Self, Error> {
        Ok(Self(scenario::load(path.as_ref(), data, &hint)?))
    }

    /// Takes a scenario from its text; files that it names are looked for in `folder`.
    ///
    /// # Errors
    /// [`ErrorKind::Scenario`](crate::ErrorKind::Scenario), with every [problem](Error::problems) of the text.
    pub fn parse(text: &str, folder: impl AsRef<Path>) -> Result<Self, Error> {
        let path = folder.as_ref().join("scenario.ron");
        Ok(Self(scenario::resolve(&path, text, &SearchPath::of(&path, &[]), &hint)?))
    }

    /// Its name: that of its file without the extension.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// What the sequence shows, on one line.
    pub fn title(&self) -> &str {
        &self.0.title
    }

    /// Number of images that it asks for.
    pub fn images(&self) -> usize {
        self.0.images()
    }

    /// What stands against it, and what its images will not be, a line each: loads kernels, opens files and computes all poses
    /// without making anything. Empty where nothing is wrong.
    pub fn check(&self, cache: impl AsRef<Path>) -> Vec<String> {
        let found = pipeline::check(&self.0, cache.as_ref(), &pipeline::Silent);
        found.problems.iter().map(ToString::to_string).chain(found.warnings).collect()
    }

    /// Makes it ready: kernels, terrain, horizons, and the pose and the lights of each exposure. Synthetic terrain and horizon
    /// tiles are kept in the folder `cache` for the next time.
    ///
    /// # Errors
    /// Any kind: this is where files are read and terrain is made.
    pub fn prepare(&self, cache: impl AsRef<Path>, progress: &dyn Progress) -> Result<Sequence, Error> {
        let mut prepared = pipeline::prepare(&self.0, cache.as_ref(), progress)?;
        let scene = pipeline::build_scene(&self.0, &mut prepared, cache.as_ref(), progress)?;
        let imaging = pipeline::scene::imaging(&self.0)?;
        Ok(Sequence { scene: Scene::new(scene), prepared, imaging })
    }

    /// Does what `sim run` does: renders all images and writes them, with their records and previews, into the folder `output`.
    ///
    /// Exposures of the same scenario that are there are written anew; those of another are kept, and the run is refused.
    ///
    /// # Errors
    /// Any kind; what was finished stays.
    pub fn run(
        &self,
        output: impl Into<PathBuf>,
        cache: impl Into<PathBuf>,
        adapter: Adapter,
        progress: &dyn Progress,
    ) -> Result<RunReport, Error> {
        let existing = Existing::default();
        let options = Options { output: output.into(), cache: cache.into(), exposures: None, existing, adapter };
        Ok(pipeline::run(&self.0, &options, progress)?)
    }
}

/// Says what a missing file is and where it can be had.
fn hint(name: &str) -> Option<String> {
    known_file(name).map(|file| format!("{}, from {}", file.what, file.source))
}

/// A scenario made ready: a scene, and a view for each exposure.
#[derive(Debug)]
pub struct Sequence {
    scene: Scene,
    prepared: Prepared,
    imaging: Imaging,
}

impl Sequence {
    /// What stays the same from exposure to exposure.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Number of exposures.
    pub fn len(&self) -> usize {
        self.prepared.exposures.len()
    }

    /// Whether there is no exposure.
    pub fn is_empty(&self) -> bool {
        self.prepared.exposures.is_empty()
    }

    /// Pose, lights and camera of an exposure in the middle of its time.
    ///
    /// # Panics
    /// Where `exposure` is not below [`len`](Self::len).
    pub fn view(&self, exposure: usize) -> &View {
        &self.prepared.exposures[exposure].view
    }

    /// The middle of an exposure.
    ///
    /// # Panics
    /// Where `exposure` is not below [`len`](Self::len).
    pub fn epoch(&self, exposure: usize) -> Epoch {
        self.prepared.exposures[exposure].epoch
    }

    /// Takes an exposure: a lens that blurs, a shutter that takes its time, the detector's noise. It has the planes that the
    /// scenario asks for, but for labels that need other exposures (`flow`, `covisible`, `shadow_change`) or a lander.
    ///
    /// # Errors
    /// [`ErrorKind::Render`](crate::ErrorKind::Render) and [`ErrorKind::Device`](crate::ErrorKind::Device).
    ///
    /// # Panics
    /// Where `exposure` is not below [`len`](Self::len).
    pub fn render(&self, session: &mut Session, exposure: usize) -> Result<Image, Error> {
        let exposure = &self.prepared.exposures[exposure];
        let captured = capture::take(&self.prepared, &self.imaging, session.engine(), exposure)?;
        Ok(captured.image(self.scene.engine()))
    }
}
