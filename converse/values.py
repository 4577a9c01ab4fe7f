"""Frozen dataclasses, ready sooner: to import the module dataclasses and to let it make ours is a
fifth of a short run.  To that module, and to whoever reads or checks types, they are dataclasses
all the same."""

from functools import lru_cache

TYPE_CHECKING = False                   # to import this from typing would take long, too

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
    from dataclasses import field as field
    from dataclasses import replace as replace
else:
    NOTHING = object()

    class field:
        def __init__(self, default=NOTHING, default_factory=None, compare=True):
            self.default, self.default_factory, self.compare = default, default_factory, compare

        def value(self):
            """What the field is where it is not given; NOTHING: it must be given."""
            return self.default_factory() if self.default_factory else self.default

        def of(self, dataclasses):
            """The same field of that module."""
            if self.default_factory:
                return dataclasses.field(default_factory=self.default_factory, compare=self.compare)
            default = dataclasses.MISSING if self.default is NOTHING else self.default
            return dataclasses.field(default=default, compare=self.compare)

    def replace(value, **changes):
        """The value with some of its fields changed."""
        return type(value)(**{**{name: getattr(value, name) for name in value.__match_args__},
                              **changes})

    class OnDemand:
        """A class attribute that is made when somebody asks for it."""

        def __init__(self, make):
            self.make = make

        def __get__(self, value, cls):
            return self.make()

    def dataclass(*, frozen, repr=True):
        assert frozen
        return lambda cls: decorated(cls, repr)

    def decorated(cls, with_repr):
        fields = {name: vars(cls).get(name, NOTHING) for name in cls.__annotations__}
        fields = {name: x if isinstance(x, field) else field(x) for name, x in fields.items()}
        compared = [name for name, x in fields.items() if x.compare]

        def key(self):
            return tuple([getattr(self, name) for name in compared])

        def init(self, *given, **named):
            if len(given) > len(fields):
                raise TypeError("%s takes %d arguments, not %d"
                                % (cls.__name__, len(fields), len(given)))
            for name, x in zip(fields, given):
                if name in named:
                    raise TypeError("%s is given twice" % name)
                named[name] = x
            for name, x in fields.items():
                vars(self)[name] = x = named.pop(name) if name in named else x.value()
                if x is NOTHING:
                    raise TypeError("%s needs the argument '%s'" % (cls.__name__, name))
            for name in named:
                raise TypeError("%s has no argument '%s'" % (cls.__name__, name))
            if hasattr(self, "__post_init__"):
                self.__post_init__()

        def equal(self, other):
            return key(self) == key(other) if type(self) is type(other) else NotImplemented

        def text(self):
            return "%s(%s)" % (cls.__qualname__, ", ".join(
                "%s=%r" % (name, getattr(self, name)) for name in fields))

        def fixed(self, name, *_):
            from dataclasses import FrozenInstanceError
            raise FrozenInstanceError("'%s' cannot be changed; use replace" % name)

        @lru_cache(None)
        def twin():
            import dataclasses
            return dataclasses.make_dataclass(cls.__name__, [
                (name, cls.__annotations__[name], x.of(dataclasses)) for name, x in fields.items()],
                frozen=True, repr=with_repr)

        def signature():
            import inspect
            return inspect.signature(twin())

        for name, x in fields.items():
            if x.default is not NOTHING:
                setattr(cls, name, x.default)
            elif name in vars(cls):
                delattr(cls, name)
        cls.__init__, cls.__eq__, cls.__hash__ = init, equal, lambda self: hash(key(self))
        cls.__setattr__ = cls.__delattr__ = fixed
        cls.__match_args__, cls.__replace__ = tuple(fields), replace
        cls.__dataclass_fields__ = OnDemand(lambda: twin().__dataclass_fields__)
        cls.__dataclass_params__ = OnDemand(lambda: twin().__dataclass_params__)
        cls.__signature__ = OnDemand(signature)
        if with_repr:
            cls.__repr__ = text
        return cls
