//! Options of the method of pages.

use crate::stages::page_requests::{PageRule, PageTree};
use crate::{Error, Result};

/// Options of `resolution-matched`, whose bias is that of [`ShadowMapSettings`](super::ShadowMapSettings).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PageSettings {
    /// Pages of 32 × 32 texels that a view of the light may take, 4 KiB each: 1 to 32768; `None`: as many as take the memory of a map of
    /// [`Settings::map`](super::Settings::map) texels a side, as far as 32768 do.
    pub pages: Option<u32>,
    /// Levels beyond that whose texels are no longer than a pixel on its receiver: 0 to [`PageSettings::FINEST`]. Each asks for four times the texels.
    pub finer: u32,
    /// Rule by which pages are asked for.
    pub rule: PageRule,
    /// Pixels that have to change in a page for a finer one by [`PageRule::Queried`], at least 1.
    pub changed: u32,
}

impl Default for PageSettings {
    fn default() -> Self {
        Self { pages: None, finer: 0, rule: PageRule::default(), changed: Self::CHANGED }
    }
}

impl PageSettings {
    /// Most levels beyond that of the pixels.
    pub const FINEST: u32 = 4;
    /// Pixels that have to change in a page by default.
    pub const CHANGED: u32 = 1;

    /// Pages that may be made for a map of so many texels a side.
    pub fn budget(&self, map: u32) -> u32 {
        self.pages.unwrap_or(PageTree::pages_of_map(map))
    }

    /// Checks the values against what is possible.
    ///
    /// # Errors
    /// [`Error::Config`] with the numbers.
    pub fn check(&self) -> Result<()> {
        let (most, finest) = (PageTree::MOST_PAGES, Self::FINEST);
        if let Some(pages) = self.pages.filter(|pages| !(1..=most).contains(pages)) {
            return Err(Error::Config(format!("{pages} pages; 1 to {most} are possible")));
        }
        if self.finer > finest {
            let finer = self.finer;
            return Err(Error::Config(format!("pages {finer} levels finer than pixels; 0 to {finest} are possible")));
        }
        if self.changed == 0 {
            return Err(Error::Config("0 changed pixels; at least 1".to_owned()));
        }
        Ok(())
    }
}
