//! Which settings another one switches off, and why: shown dimmed, so that nobody looks for their
//! effect.

use crate::technique::Choice;

/// A setting without effect while another one has, or has not, a value.
struct Off {
    key: &'static str,
    because_of: &'static str,
    /// Off while the other one has this value, or with `false`: any other.
    is: bool,
    value: &'static str,
    reason: &'static str,
}

const OFF: [Off; 4] = [
    Off {
        key: "epsilon",
        because_of: "depth",
        is: false,
        value: "standard-infinite-epsilon",
        reason: "No effect: only depth = standard-infinite-epsilon pulls infinity in",
    },
    Off {
        key: "blend",
        because_of: "stencil",
        is: true,
        value: "off",
        reason: "No effect: without the stencil nothing keeps a pixel from being darkened twice",
    },
    Off {
        key: "faces",
        because_of: "counter",
        is: true,
        value: "float",
        reason: "No effect: a float target adds and takes away in one draw",
    },
    Off {
        key: "operations",
        because_of: "counter",
        is: true,
        value: "float",
        reason: "No effect: a float target has no limits to wrap or stop at",
    },
];

/// Why a setting has no effect now; `None` where it has.
#[must_use]
pub fn reason(choice: &Choice, key: &str) -> Option<&'static str> {
    let is_off = |off: &&Off| {
        off.key == key && choice.settings().get(off.because_of).is_some_and(|value| (value == off.value) == off.is)
    };
    OFF.iter().find(is_off).map(|off| off.reason)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::technique::Technique;

    fn off(technique: Technique, changes: &[(&str, &str)]) -> Vec<&'static str> {
        let mut choice = Choice::new(technique);
        changes.iter().for_each(|(key, value)| choice.set(key, value).expect("a setting"));
        let keys = technique.settings().iter().map(|spec| spec.key);
        keys.filter(|key| reason(&choice, key).is_some()).collect()
    }

    #[test]
    fn what_has_no_effect_is_told() {
        assert_eq!(off(Technique::Planar, &[]), ["epsilon"]);
        assert_eq!(off(Technique::Planar, &[("stencil", "off")]), ["epsilon", "blend"]);
        assert!(off(Technique::ZFail, &[("depth", "standard-infinite-epsilon")]).is_empty());
        assert_eq!(off(Technique::ZPass, &[("counter", "float")]), ["epsilon", "faces", "operations"]);
    }

    #[test]
    fn every_key_and_value_is_one_that_a_technique_has() {
        for Off { key, because_of, value, .. } in OFF {
            let has = |technique: &Technique| {
                let keys: Vec<&str> = technique.settings().iter().map(|spec| spec.key).collect();
                keys.contains(&key) && Choice::new(*technique).set(because_of, value).is_ok()
            };
            assert!(Technique::ALL.iter().any(has), "{key}");
        }
    }
}
