//! Setting up a scene on another thread.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use meshlod_school::scene::{Scenario, ScenarioName};

use super::SchoolWindowOptions;
use crate::{Renderer, SchoolShow};

/// Scene that is being set up.
#[derive(Debug)]
pub(crate) struct ComingScene {
    pub name: ScenarioName,
    receiver: Receiver<Result<Box<SchoolShow>, String>>,
}

impl ComingScene {
    /// Starts to set up a scene; a scenario that is there already spares making it.
    pub fn start(
        name: ScenarioName,
        scenario: Option<Scenario>,
        renderer: &Arc<Renderer>,
        options: &SchoolWindowOptions,
        wake: &egui::Context,
    ) -> Self {
        let (sender, receiver) = channel();
        let (renderer, options, wake) = (Arc::clone(renderer), options.clone(), wake.clone());
        std::thread::spawn(move || {
            let scenario = scenario.map_or_else(|| (options.scenes)(name), Ok);
            let show = scenario.and_then(|scenario| {
                let impostor = options.impostor.as_deref();
                SchoolShow::new(&renderer, scenario, &options.table, &options.look, impostor)
                    .map_err(|error| error.to_string())
            });
            // Nobody listens once the window is closed or another scene is wanted.
            let _ = sender.send(show.map(Box::new));
            wake.request_repaint();
        });
        Self { name, receiver }
    }

    /// Returns the scene or what went wrong; `None` while it is on its way.
    pub fn take(&self) -> Option<Result<Box<SchoolShow>, String>> {
        match self.receiver.try_recv() {
            Ok(done) => Some(done),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(format!("the scene {} cannot be set up", self.name.name())))
            }
        }
    }
}
