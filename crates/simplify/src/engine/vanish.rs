//! Removal of whole connected components.

use crate::engine::Engine;
use crate::engine::policy::{Candidates, Memory, Observe, Placement, Priority, Stop};
use crate::engine::vanishing::VanishingComponent;
use crate::refusal::Refusal;

impl<C, M, P, L> Engine<C, M, P, L>
where
    C: Candidates,
    M: Memory,
    P: Priority<M>,
    L: Placement<M>,
{
    /// Removes a component, unless it is the last or larger than the error bound. Returns true if
    /// it was removed.
    pub(super) fn vanish(
        &mut self,
        component: VanishingComponent,
        stop: &Stop,
        observer: &mut dyn Observe,
    ) -> bool {
        let surface = &mut self.surface;
        let left = component.faces.iter().copied().filter(|&face| surface.is_alive(face));
        let left: Vec<_> = left.collect();
        if left.len() == surface.live_faces() {
            self.refusals.add(Refusal::LastFaces);
            return false;
        }
        if component.size > stop.error {
            self.refusals.add(Refusal::Error);
            self.refused_above = self.refused_above.min(stop.error);
            self.vanishing.refuse(component);
            return false;
        }
        let observer = &mut (&mut self.volume, observer);
        observer.vanish(surface, &left);
        surface.take_out(&component.faces);
        observer.gone(left.len());
        self.error_estimate = self.error_estimate.max(component.size);
        self.vanished += 1;
        true
    }
}
