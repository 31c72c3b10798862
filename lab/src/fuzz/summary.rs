//! The findings of a run, as tables and as a page.

use super::{Fault, Figures, FuzzCase, Kind, Verdict};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use subpixel_shadows::methods::MethodName;

/// Cases of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Cases, those that were refused included.
    pub cases: u64,
    /// Cases that the program refuses.
    pub refused: u64,
    /// Cases with a fault.
    pub failed: u64,
    /// Samples of all.
    pub figures: Figures,
}

impl Tally {
    fn add(&mut self, o: &Self) {
        self.cases += o.cases;
        self.refused += o.refused;
        self.failed += o.failed;
        self.figures.compared += o.figures.compared;
        self.figures.wrong += o.figures.wrong;
        self.figures.ambiguous += o.figures.ambiguous;
        self.figures.seen += o.figures.seen;
        self.figures.tied += o.figures.tied;
        self.figures.by_table += o.figures.by_table;
    }
}

/// A case that failed.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Its seed and number.
    pub case: [u64; 2],
    /// Its kind.
    pub kind: Kind,
    /// Its faults.
    pub faults: Vec<(Fault, u64, String)>,
    /// The command that repeats it, and its triangles and pixels once shrunk, where it was written.
    pub repeat: Option<(String, [u64; 2])>,
}

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// By kind.
    pub kinds: BTreeMap<Kind, Tally>,
    /// By the method's name.
    pub methods: BTreeMap<&'static str, u64>,
    /// Frames that were rendered a second time with everything run.
    pub forced: u64,
    /// Worlds with alpha-tested triangles.
    pub holes: u64,
    /// Why cases were refused, numbers left out, and how often.
    pub refusals: BTreeMap<String, u64>,
    /// Failures, in order.
    pub failures: Vec<Failure>,
    /// Seconds, shrinking left out.
    pub seconds: f64,
}

impl Summary {
    /// Takes in a case that was judged.
    pub fn judged(&mut self, case: &FuzzCase, verdict: &Verdict) {
        let one = Tally { cases: 1, refused: 0, failed: u64::from(verdict.fails()), figures: verdict.figures };
        self.forced += u64::from(case.how.both);
        self.holes += u64::from(!case.world.alpha.is_empty());
        self.count(case, &one);
    }

    /// Takes in a case that was refused.
    pub fn refused(&mut self, case: &FuzzCase, reason: &str) {
        self.count(case, &Tally { cases: 1, refused: 1, ..Tally::default() });
        let plain: String = reason.chars().map(|c| if c.is_ascii_digit() { '#' } else { c }).collect();
        let mut short = plain;
        while short.contains("##") {
            short = short.replace("##", "#");
        }
        *self.refusals.entry(short).or_default() += 1;
    }

    fn count(&mut self, case: &FuzzCase, one: &Tally) {
        self.kinds.entry(case.kind).or_default().add(one);
        *self.methods.entry(case.how.method.name()).or_default() += 1;
    }

    /// All kinds together.
    pub fn all(&self) -> Tally {
        let mut all = Tally::default();
        self.kinds.values().for_each(|tally| all.add(tally));
        all
    }

    /// The table by kind, a heading first, the sum last; numbers as `grouped` writes them.
    pub fn rows(&self, grouped: fn(u64) -> String) -> Vec<Vec<String>> {
        let heading = [
            "kind",
            "cases",
            "refused",
            "failed",
            "samples compared",
            "surfaces asked",
            "wrong",
            "in the band",
            "tied",
            "by table",
        ];
        let row = |name: &str, t: &Tally| {
            let f = &t.figures;
            let numbers = [t.cases, t.refused, t.failed, f.compared, f.seen, f.wrong, f.ambiguous, f.tied, f.by_table];
            std::iter::once(name.to_owned()).chain(numbers.map(grouped)).collect()
        };
        let mut rows = vec![heading.map(String::from).to_vec()];
        rows.extend(self.kinds.iter().map(|(kind, tally)| row(kind.name(), tally)));
        rows.push(row("all", &self.all()));
        rows
    }

    /// One line on what the run was made of.
    pub fn line(&self) -> String {
        let cases = self.all().cases;
        let own = [MethodName::FacetMasks, MethodName::RayTraced, MethodName::Supersampled]
            .map(|method| self.methods.get(method.name()).copied().unwrap_or(0));
        format!(
            "{} frames of facet-masks, {} of ray-traced, {} of supersampled, {} of methods of texels, {} also with everything run; {} worlds with alpha-tested triangles; {:.0} s, {:.1} cases a second",
            own[0],
            own[1],
            own[2],
            cases - own.iter().sum::<u64>(),
            self.forced,
            self.holes,
            self.seconds,
            cases as f64 / self.seconds.max(1e-9)
        )
    }

    /// The page of a run.
    pub fn markdown(&self, command: &str, machine: &str, grouped: fn(u64) -> String) -> String {
        let mut out = format!("# Random worlds\n\n`{command}`\n\n{machine}.\n\n");
        out += "Each case is a world of one kind, with camera, light and settings of its own, all drawn from the seed. The frame and that of \
                the CPU engine are held against facet truth, and with a surface for every sample, sample by sample, against scene truth; samples \
                that are compared count once for each. Methods of texels promise no sample: their pictures are shares from 0 to 1, the same in a second frame and \
                with everything run. In the band: within 1/256 pixel of an edge, where either answer may be given. By table: wrong by \
                `--masks table`, which rounds, within its bound. Refused: with one line, as the program refuses it.\n\n";
        let all = self.all();
        let _ = writeln!(
            out,
            "{} cases: {} failed, {} refused. {}.\n",
            grouped(all.cases),
            grouped(all.failed),
            grouped(all.refused),
            self.line()
        );
        for (k, row) in self.rows(grouped).iter().enumerate() {
            let _ = writeln!(out, "| {} |", row.join(" | "));
            if k == 0 {
                let _ = writeln!(out, "|{}", "---|".repeat(row.len()));
            }
        }
        if !self.refusals.is_empty() {
            out += "\n| refused because | cases |\n|---|---|\n";
            for (reason, count) in &self.refusals {
                let _ = writeln!(out, "| {reason} | {count} |");
            }
        }
        if !self.failures.is_empty() {
            out += "\n| case | kind | fault | repeated by |\n|---|---|---|---|\n";
            for Failure { case: [seed, number], kind, faults, repeat } in &self.failures {
                let text: Vec<String> = faults.iter().map(|(f, n, at)| format!("{n} {}; {at}", f.name())).collect();
                let command = repeat.as_ref().map_or(String::new(), |(command, _)| format!("`{command}`"));
                let name = kind.name();
                let _ = writeln!(out, "| {number} of seed {seed} | {name} | {} | {command} |", text.join(", "));
            }
        }
        out
    }
}
