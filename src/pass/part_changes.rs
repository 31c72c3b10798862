//! Parts of the casters that are added and removed while the pass goes on.

use super::casters::CasterSet;
use super::checks::check_tested;
use super::parts::NewPart;
use super::views::Views;
use super::{CasterPart, ShadowPass};
use crate::{Error, Result};
use std::ops::Range;

impl ShadowPass {
    /// Adds a part to casters that are in [parts](super::Casters::Parts), and returns its number, which is never given again. The CPU prepares this part alone,
    /// and no pipeline is compiled. Frames that are recorded from now on have it, others that were recorded before have not, if frames are submitted in the
    /// order in which they were recorded.
    ///
    /// Where the memory has no room for it, memory is made anew, for twice as much, and all parts are written again as they were prepared;
    /// lists stay as long as they are.
    ///
    /// # Errors
    /// [`Error::Config`] for casters that are in no parts, and for a part with alpha-tested triangles where the settings have none
    /// ([`alpha_tested`](crate::methods::Settings::alpha_tested)); [`Error::Mesh`] for a part that is no geometry; [`Error::Memory`] and [`Error::Gpu`] if
    /// memory does not suffice. The pass is then as before.
    pub fn add_part(&mut self, part: &CasterPart) -> Result<u32> {
        self.ledger.clone().within(|| self.add(part))
    }

    fn add(&mut self, part: &CasterPart) -> Result<u32> {
        let (device, queue) = (self.maker.device.clone(), self.maker.queue.clone());
        let first = self.casters.first_element();
        let Some(parts) = &mut self.casters.parts else { return Err(no_parts()) };
        let new = NewPart::new(part, "the part")?;
        check_tested(new.is_tested(), &self.settings, self.maker.pipelines.method())?;
        if parts.fits(&new) {
            let number = parts.insert(&device, &queue, new)?;
            parts.write(&device, number, (&self.casters.buffers, &self.casters.numbers), first)?;
            self.have_changed();
            return Ok(number);
        }
        let mut grown = parts.successor();
        grown.extend_for(&new, 2)?;
        let number = grown.insert(&device, &queue, new)?;
        let set = CasterSet::of_parts(&device, &queue, grown)?;
        self.rebuild(self.settings.clone(), Some(set), Some(self.image.method.capacities()))?;
        Ok(number)
    }

    /// Removes a part: it casts, receives and is seen in no frame that is recorded from now on. Its memory serves parts that are added later. A G-buffer that
    /// still shows its triangles' numbers shows nothing there.
    ///
    /// # Errors
    /// [`Error::Config`] if there is no such part; [`Error::Gpu`] if the device has no memory for the commands. The pass is then as before.
    pub fn remove_part(&mut self, part: u32) -> Result<()> {
        let device = self.maker.device.clone();
        let ledger = self.ledger.clone();
        let Some(parts) = &mut self.casters.parts else { return Err(no_parts()) };
        ledger.within(|| parts.remove(&device, part, (&self.casters.buffers, &self.casters.numbers)))?;
        // They hold its vertices and transforms.
        self.bind_groups.forget();
        self.have_changed();
        Ok(())
    }

    /// Numbers of a part's triangles in G-buffers, in the order in which they were given, instance by instance; `None` if there is no such part.
    pub fn part_triangles(&self, part: u32) -> Option<Range<u32>> {
        self.casters.parts.as_ref()?.triangles(part)
    }

    /// Maps of casters that stood are of others now.
    fn have_changed(&mut self) {
        self.views = Views::default();
        self.kept_maps.forget();
    }
}

fn no_parts() -> Error {
    Error::Config("the pass has casters that are in no parts: they are given all at once".to_owned())
}
